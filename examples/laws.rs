//! The picture of the formulas: ΔCD by the size of each error.
//!
//! `cargo run --example laws > docs/laws.svg` writes it; the continuous integration holds the file to it. The pair is
//! that of the manual's first calculation: α_n = 20°, the rack's helix angle 12° and the pinion's 30°; the lead is f_Hβ
//! over the face width.

use std::error::Error;

use rackmesh::formula::law::lead_slope;
use rackmesh::formula::{Law, Model};
use rackmesh::quantity::{Angle, Length, LengthUnit};
use rackmesh::report::chart::{Axis, Chart, Layer, Scale, Shape};

/// The largest error shown, µm.
const LARGEST: i64 = 20;

fn main() -> Result<(), Box<dyn Error>> {
    let [pressure_angle, of_rack, of_pinion] = ["20", "12", "30"].map(str::parse::<Angle>);
    let (pressure_angle, of_rack, of_pinion) = (pressure_angle?, of_rack?, of_pinion?);
    let face_width: Length = "20".parse()?;
    let laws = [
        ("over-roller, radial", Law::rack_over_roller()),
        ("rack pitch", Law::rack_pitch(pressure_angle, of_rack)?),
        ("pinion pitch", Law::pinion_pitch(pressure_angle, of_pinion)?),
        ("rack lead f_Hβ", Law::rack_lead(pressure_angle, of_rack, face_width)?),
        ("pinion lead f_Hβ", Law::pinion_lead(pressure_angle, of_pinion)?),
    ];
    let mut layers = Vec::new();
    for (name, law) in laws {
        let mut points = Vec::new();
        for error in -LARGEST..=LARGEST {
            let length = Length::from_mm(error as f64 / 1000.0)?;
            let delta_cd = if name == "rack lead f_Hβ" {
                law.delta_cd(lead_slope(length, face_width)?, Model::Exact)?
            } else {
                law.delta_cd(length, Model::Exact)?
            };
            points.push((error as f64, delta_cd.in_unit(LengthUnit::Micrometre)));
        }
        layers.push(Layer::new(name, Shape::Line(points)));
    }
    let chart = Chart {
        title: "ΔCD by the size of each error: α_n = 20°, helix angles 12° and 30°".to_owned(),
        x: Axis { label: "error [µm]".to_owned(), scale: Scale::Tight },
        y: Axis { label: "ΔCD [µm]".to_owned(), scale: Scale::Airy },
        layers,
        ..Chart::default()
    };
    print!("{}", chart.svg().ok_or("there is nothing to show")?);
    Ok(())
}
