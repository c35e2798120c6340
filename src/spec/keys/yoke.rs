//! The keys of `[yoke]` and of the rack's travel: a part of the table in [`keys`](super).

use super::kind::{Key, Kind, MeasureUnit, Section, angle, from_zero, length, measure, of, section};
use crate::function::SetAt;
use crate::quantity::{Angle, Domain, Length};

section! {
    TRAVEL = "rack.travel", "The strokes of the rack on its gear." {
        RACK_TRAVEL_FROM: Length = "from", length(Domain::any("start of the travel", "s")), "First.";
        RACK_TRAVEL_TO: Length = "to", length(Domain::any("end of the travel", "s")), "Last.";
    }
}

section! {
    YOKE_FRICTION = "yoke.friction", "Coefficients of friction." {
        YOKE_FRICTION_YOKE: f64 = "yoke", measure(from_zero("friction of the yoke", "μ_y"), MeasureUnit::NONE),
            "μ_y, yoke on rack.";
        YOKE_FRICTION_TEETH: f64 = "teeth", measure(from_zero("friction at the teeth", "μ_m"), MeasureUnit::NONE),
            "μ_m, teeth.";
    }
}

section! {
    YOKE = "yoke", "The sprung yoke behind the rack." {
        YOKE_PRELOAD: f64 = "preload", measure(Domain::positive("preload of the yoke's spring", "F_0"), MeasureUnit::FORCE),
            "Force at set_at, play set. simulate: default simulation.preload.";
        YOKE_RATE: f64 = "rate", measure(from_zero("rate of the yoke's spring", "k_y"), MeasureUnit::RATE),
            "Rate of the spring. simulate: default 100 N/mm.";
        YOKE_SET_AT: SetAt = "set_at", Key::<SetAt>::new(Kind::SetAt),
            "Stroke of the setting, or \"tightest\". Default 0.";
        YOKE_SET_PLAY: Length = "set_play", length(from_zero("play of the yoke", "J_0")), "Play left there.";
        YOKE_BACK_OFF: Angle = "back_off", angle(from_zero("angle of the plug", "φ")),
            "Or set_play: turn of the plug back from its seat.";
        YOKE_THREAD_PITCH: Length = "thread_pitch", length(Domain::positive("pitch of the plug's thread", "P")),
            "Pitch of the plug's thread.";
        "friction", of(Kind::Table(&YOKE_FRICTION)), "Coefficients of friction.";
        YOKE_BEARING_TORQUE: f64 = "bearing_torque",
            measure(from_zero("torque of the bearings", "T_0"), MeasureUnit::TORQUE),
            "Torque of the bearings and seals.";
        YOKE_CLEARANCE: Length = "clearance", length(from_zero("clearance of the yoke", "s_y")),
            "simulate: travel from a_0 to the stop. Default: by the play set, or 0.15 mm.";
        YOKE_STOP: f64 = "stop", measure(from_zero("stiffness of the yoke's stop", "c_s"), MeasureUnit::RATE),
            "simulate: the stop. Default 1e5 N/mm.";
        YOKE_BUSH: f64 = "bush", measure(from_zero("stiffness of the bush", "c_b"), MeasureUnit::RATE),
            "simulate: the rack's bush as felt at the mesh. Default 20 N/mm.";
    }
}
