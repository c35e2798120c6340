//! A measured curve beside the computed one: the part of `mesh --measured`.

use serde_json::{Value, json};

use super::chart::{Axis, Chart, Layer, Scale, Shape};
use super::number::{millimetres, tidy, unsigned};
use super::{Block, Table, diagnosis, fact};
use crate::gear::Pair;
use crate::trace::{Diagnosis, Fitted, Order, Overlay, Spectrum};

/// A measured curve on that of a mesh.
#[derive(Debug)]
pub struct TracePart {
    /// The table that it comes from.
    pub file: String,
    /// How both lie on each other.
    pub overlay: Overlay,
    /// Whether the pinion is a master, so that the measured variation is the rack's.
    pub is_master: bool,
    /// The pair.
    pub pair: Pair,
    /// Which errors of teeth explain it, if that was asked.
    pub diagnosis: Option<Diagnosis>,
    /// Remarks on the points.
    pub notes: Vec<String>,
}

/// What a stroke shift at an end of its range means.
pub(super) const AT_AN_END: &str =
    "the stroke shift lies at the end of the half pitch in which it is sought: the curves may be of other teeth";

const METHOD: &str = "a constant and the sines of all orders together, by least squares";

fn um(mm: f64) -> String {
    format!("{:.2} µm", tidy(1000.0 * mm))
}

impl TracePart {
    fn names(&self) -> [&'static str; 2] {
        if self.is_master {
            ["peak to peak: F_i″ of the rack", "tooth to tooth: f_i″ of the rack"]
        } else {
            ["peak to peak", "tooth to tooth"]
        }
    }

    /// What is shown of the orders: the first ones, the tooth mesh, and the largest of the others.
    fn shown_orders(&self, spectrum: &Spectrum) -> Vec<Order> {
        const FIRST: u32 = 3;
        const MOST: usize = 10;
        let is_always = |order: &&Order| order.order <= FIRST || order.order.is_multiple_of(self.pair.pinion().teeth);
        let (mut shown, mut others): (Vec<&Order>, Vec<&Order>) = spectrum.orders.iter().partition(is_always);
        let largest = |order: &Order| order.amplitudes_mm[0].max(order.amplitudes_mm[1]);
        others.sort_by(|a, b| largest(b).total_cmp(&largest(a)));
        shown.extend(others.into_iter().take(MOST.saturating_sub(shown.len())));
        shown.sort_by_key(|order| order.order);
        shown.into_iter().copied().collect()
    }

    fn order_name(&self, order: u32) -> String {
        match (order, order % self.pair.pinion().teeth, order / self.pair.pinion().teeth) {
            (_, 0, 1) => format!("order {order}: tooth mesh"),
            (_, 0, times) => format!("order {order}: {times} × tooth mesh"),
            (1, ..) => "order 1: turn of the pinion".to_owned(),
            _ => format!("order {order}"),
        }
    }

    /// The part in JSON.
    #[must_use]
    pub fn json(&self) -> Value {
        let overlay = &self.overlay;
        let fitted = |fitted: Option<Fitted>| {
            fitted.map(|Fitted { value_mm, uncertainty_mm }| {
                json!({ "value_mm": tidy(value_mm), "standard_uncertainty_mm": tidy(uncertainty_mm) })
            })
        };
        let curve = |at: usize| {
            let variation = overlay.variations[at];
            let orders = overlay.spectrum.iter().flat_map(|spectrum| &spectrum.orders);
            let orders =
                orders.map(|order| json!({ "order": order.order, "amplitude_mm": tidy(order.amplitudes_mm[at]) }));
            json!({
                "peak_to_peak_mm": tidy(variation.peak_to_peak_mm),
                "tooth_to_tooth_mm": tidy(variation.tooth_to_tooth_mm),
                "orders": orders.collect::<Vec<_>>(),
            })
        };
        let explained_mm = |at: usize| Some(tidy(*self.diagnosis.as_ref()?.explained_mm.get(at)?));
        let points = overlay.points.iter().zip(&overlay.computed_mm).enumerate().map(|(at, (point, computed))| {
            json!({
                "stroke_mm": point.stroke_mm,
                "measured_mm": tidy(point.delta_cd_mm),
                "computed_mm": tidy(*computed),
                "difference_mm": tidy(point.delta_cd_mm - computed),
                "explained_mm": explained_mm(at),
            })
        });
        let explained = self.diagnosis.as_ref().map(|found| diagnosis::json(found, overlay.placement.is_some()));
        json!({
            "explained": explained,
            "file": self.file,
            "is_fitted": overlay.placement.is_some(),
            "offset": fitted(overlay.placement.map(|placement| placement.offset)),
            "stroke_shift": fitted(overlay.placement.and_then(|placement| placement.shift)),
            "rms_difference_mm": tidy(overlay.rms_mm),
            "largest_difference_mm": tidy(overlay.largest_mm),
            "largest_difference_stroke_mm": overlay.farthest.stroke_mm,
            "pinion_is_master": self.is_master,
            "measured": curve(0),
            "computed": curve(1),
            "turns_of_pinion": overlay.spectrum.as_ref().map(|spectrum| tidy(spectrum.turns)),
            "spectrum_by": METHOD,
            "points": points.collect::<Vec<_>>(),
            "notes": self.notes,
        })
    }

    /// The errors that explain the curve in JSON, if that was asked.
    #[must_use]
    pub fn diagnosis_json(&self) -> Option<Value> {
        Some(diagnosis::errors_json(self.diagnosis.as_ref()?, &self.pair))
    }

    /// The measured points as rows, with the computed curve at each.
    #[must_use]
    pub fn rows(&self) -> Vec<Vec<String>> {
        let explained = if self.diagnosis.is_some() { " explained_mm" } else { "" };
        let columns = format!("stroke_mm measured_mm computed_mm difference_mm{explained}");
        fact::rows(&self.json(), "points", &columns)
    }

    /// The part for people.
    #[must_use]
    pub fn blocks(&self) -> Vec<Block> {
        let overlay = &self.overlay;
        let mm = |value: f64| format!("{} mm", millimetres(tidy(value)));
        let uncertainty = |fitted: Fitted| format!("{} mm", unsigned(fitted.uncertainty_mm));
        let mut rows = Vec::new();
        if let Some(placement) = &overlay.placement {
            rows.push(("offset", mm(placement.offset.value_mm), uncertainty(placement.offset), String::new()));
            rows.extend(
                placement.shift.map(|shift| ("stroke shift", mm(shift.value_mm), uncertainty(shift), String::new())),
            );
        }
        rows.push(("rms difference", format!("{} mm", unsigned(tidy(overlay.rms_mm))), String::new(), String::new()));
        let at = format!("{:.4}", overlay.farthest.stroke_mm);
        rows.push(("largest difference", mm(overlay.largest_mm), String::new(), at));
        let laid = Table::of(rows)
            .text("measured less computed", |row| row.0)
            .number("value", |row| row.1.clone())
            .number("u", |row| row.2.clone())
            .number("at stroke [mm]", |row| row.3.clone());
        let [measured, computed] = overlay.variations;
        let names = self.names();
        let mut curves = vec![
            (names[0].to_owned(), [measured.peak_to_peak_mm, computed.peak_to_peak_mm].map(um)),
            (names[1].to_owned(), [measured.tooth_to_tooth_mm, computed.tooth_to_tooth_mm].map(um)),
        ];
        let orders = overlay.spectrum.iter().flat_map(|spectrum| self.shown_orders(spectrum));
        curves.extend(orders.map(|order| (self.order_name(order.order), order.amplitudes_mm.map(um))));
        let curves = Table::of(curves)
            .text("curve", |row| row.0.clone())
            .number("measured", |row| row.1[0].clone())
            .number("computed", |row| row.1[1].clone());
        let mut blocks = vec![laid.block(), curves.block()];
        blocks.extend(self.diagnosis.iter().flat_map(|found| diagnosis::blocks(found, overlay.placement.is_some())));
        blocks.extend(self.remarks().into_iter().map(Block::Remark));
        blocks
    }

    /// Remarks on the comparison, the points that are left out first.
    fn remarks(&self) -> Vec<String> {
        let mut remarks = self.notes.clone();
        if let Some(placement) = &self.overlay.placement {
            if placement.shift.is_none() {
                let told = if self.diagnosis.as_ref().is_some_and(|found| !found.errors.is_empty()) {
                    "; the errors found tell theirs"
                } else {
                    ""
                };
                remarks.push(format!(
                    "the computed curve varies too little to tell a stroke shift, and is compared as if there were none{told}"
                ));
            } else if placement.at_an_end {
                remarks.push(AT_AN_END.to_owned());
            }
        }
        remarks.push(match &self.overlay.spectrum {
            None => "the points are too few, or cover no pitch, so there are no orders".to_owned(),
            Some(spectrum) if spectrum.orders.first().is_some_and(|order| order.order == 1) => {
                format!("orders are amplitudes of {METHOD}; {:.2} turns of the pinion", spectrum.turns)
            }
            Some(spectrum) => format!(
                "{:.2} turns of the pinion tell no orders but the tooth mesh: amplitudes of {METHOD}",
                spectrum.turns
            ),
        });
        remarks
    }

    /// The measured points: stroke and ΔCD, mm.
    pub(super) fn curve(&self) -> Vec<(f64, f64)> {
        self.overlay.points.iter().map(|point| (point.stroke_mm, point.delta_cd_mm)).collect()
    }

    /// Measured over computed, the difference below.
    #[must_use]
    pub fn chart(&self, title: &str) -> Chart {
        let overlay = &self.overlay;
        let over = |values: &mut dyn Iterator<Item = f64>| -> Vec<(f64, f64)> {
            overlay.points.iter().map(|point| point.stroke_mm).zip(values).collect()
        };
        let placed = if overlay.placement.is_some() { "computed, placed by least squares" } else { "computed" };
        let mut layers = vec![
            Layer::new("measured", Shape::Line(self.curve())),
            Layer::new(placed, Shape::Line(over(&mut overlay.computed_mm.iter().copied()))),
        ];
        let left = if self.diagnosis.is_some() { "left by the computed curve" } else { "" };
        let mut differences =
            vec![Layer::new(left, Shape::Line(over(&mut overlay.differences_mm().map(|mm| 1000.0 * mm))))];
        if let Some(found) = &self.diagnosis {
            let with = "computed with the errors found";
            layers.push(Layer::new(with, Shape::Line(over(&mut found.explained_mm.iter().copied()))));
            let left = overlay.points.iter().zip(&found.explained_mm);
            let mut left = left.map(|(point, explained)| 1000.0 * (point.delta_cd_mm - explained));
            differences.push(Layer::new("left by the errors found", Shape::Line(over(&mut left))));
        }
        let below = Chart {
            y: Axis { label: "measured − computed [µm]".to_owned(), scale: Scale::Airy },
            height: 260.0,
            ..Chart::along_the_stroke("", differences)
        };
        Chart { below: Some(Box::new(below)), ..Chart::along_the_stroke(title, layers) }
    }
}
