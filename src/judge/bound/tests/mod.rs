//! The bound against closed forms and against the exact mesh.

mod closed;
mod property;
mod random;
mod tight;
