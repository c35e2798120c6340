//! The bound against closed forms and against the exact mesh.

mod property;
mod random;
mod tight;
