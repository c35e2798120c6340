//! The words with which people write tables of measured parts: headings, units, and columns that are no errors, in the four
//! languages.

use rackmesh::deviation::DeviationKind;

/// The language of a table's headings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    English,
    German,
    French,
    Japanese,
}

/// What an error is called.
#[derive(Debug, Clone, Copy)]
pub struct Title {
    pub text: &'static str,
    /// Whether the name says that it is a deviation.
    pub is_deviation: bool,
    /// Whether the name says that it is a measured value.
    pub is_measured: bool,
    /// Whether it is the key, which has a unit of its own.
    pub is_key: bool,
}

/// A unit as people spell it.
#[derive(Debug, Clone, Copy)]
pub struct UnitWord {
    pub spelling: &'static str,
    /// As the quantities' parser reads it.
    pub symbol: &'static str,
    /// One of it, mm or degrees.
    pub size: f64,
    pub is_angle: bool,
    /// Whether it is a unit also in round brackets or without any.
    pub is_clear: bool,
    /// Whether it can stand behind a number.
    pub in_cells: bool,
}

const fn unit(spelling: &'static str, symbol: &'static str, size: f64) -> UnitWord {
    UnitWord { spelling, symbol, size, is_angle: false, is_clear: true, in_cells: true }
}

const fn angle(spelling: &'static str, symbol: &'static str, size: f64) -> UnitWord {
    UnitWord { is_angle: true, ..unit(spelling, symbol, size) }
}

const fn unclear(word: UnitWord) -> UnitWord {
    UnitWord { is_clear: false, ..word }
}

const fn in_headings(word: UnitWord) -> UnitWord {
    UnitWord { in_cells: false, ..word }
}

pub const LENGTHS: &[UnitWord] = &[
    unit("mm", "mm", 1.0),
    unit("\u{b5}m", "um", 1e-3),
    unit("\u{3bc}m", "um", 1e-3),
    unit("\u{339b}", "um", 1e-3),
    unit("um", "um", 1e-3),
    unit("micron", "um", 1e-3),
    in_headings(unit("1/1000 mm", "um", 1e-3)),
    unit("nm", "nm", 1e-6),
    unit("\u{339c}", "mm", 1.0),
    unit("cm", "cm", 10.0),
    unclear(unit("m", "m", 1000.0)),
    unclear(unit("in", "in", 25.4)),
    unit("inch", "in", 25.4),
    unclear(unit("\u{2033}", "in", 25.4)),
    unit("mil", "mil", 0.0254),
    unit("thou", "mil", 0.0254),
];

pub const ANGLES: &[UnitWord] = &[
    angle("deg", "deg", 1.0),
    angle("\u{b0}", "deg", 1.0),
    angle("arcmin", "arcmin", 1.0 / 60.0),
    unclear(in_headings(angle("min", "arcmin", 1.0 / 60.0))),
    unclear(angle("\u{2032}", "arcmin", 1.0 / 60.0)),
    unclear(angle("'", "arcmin", 1.0 / 60.0)),
    angle("arcsec", "arcsec", 1.0 / 3600.0),
    unclear(angle("\u{2033}", "arcsec", 1.0 / 3600.0)),
    angle("rad", "rad", 57.3),
    angle("mrad", "mrad", 0.0573),
    angle("\u{b5}rad", "urad", 0.000_057_3),
    angle("gon", "gon", 0.9),
];

/// A name that may stand over measured values and over deviations.
const fn open(text: &'static str) -> Title {
    Title { text, is_deviation: false, is_measured: false, is_key: false }
}

const fn key(text: &'static str) -> Title {
    Title { is_key: true, ..open(text) }
}

const fn deviation(text: &'static str) -> Title {
    Title { is_deviation: true, ..open(text) }
}

const fn measured(text: &'static str) -> Title {
    Title { is_measured: true, ..open(text) }
}

/// A column that is no error.
#[derive(Debug, Clone, Copy)]
pub struct Context {
    pub title: &'static str,
    pub values: [&'static str; 3],
}

const fn context(title: &'static str, values: [&'static str; 3]) -> Context {
    Context { title, values }
}

/// Words that make a heading that of a companion.
#[derive(Debug, Clone, Copy)]
pub struct Suffixes {
    pub nominal: &'static str,
    pub upper: &'static str,
    pub lower: &'static str,
    pub deviation: &'static str,
}

/// The headings of a table with a row per characteristic.
#[derive(Debug, Clone, Copy)]
pub struct Heads {
    pub name: &'static str,
    pub nominal: &'static str,
    pub actual: &'static str,
    pub deviation: &'static str,
    pub upper: &'static str,
    pub lower: &'static str,
    pub unit: &'static str,
}

// the titles of the errors, in the order of `DeviationKind::ALL`
const ENGLISH: [&[Title]; 6] = [
    &[
        key("rack_over_roller"),
        open("Rack over roller"),
        open("Measurement over roller(s)"),
        open("M"),
        measured("rack over roller actual"),
        deviation("over roller deviation"),
    ],
    &[key("rack_pitch"), open("rack pitch"), deviation("Pitch error of rack"), deviation("Δp"), deviation("dp")],
    &[key("rack_lead"), open("lead"), deviation("lead error"), deviation("helix slope deviation"), deviation("fHβ")],
    &[key("pinion_radial"), open("Pinion radial"), deviation("radial error"), deviation("Δr")],
    &[
        key("pinion_pitch"),
        deviation("f_p"),
        deviation("pitch deviation, pinion, single"),
        deviation("single pitch deviation fpt pinion"),
    ],
    &[key("pinion_lead"), open("pinion lead"), deviation("pinion fHβ"), deviation("helix slope deviation, pinion")],
];

const GERMAN: [&[Title]; 6] = [
    &[
        open("Rollenmaß"),
        open("Maß über Rolle"),
        open("Mass ueber Rolle"),
        measured("Rollenmaß Ist"),
        deviation("Kugelmaß-Abweichung"),
        deviation("ΔM"),
    ],
    &[
        open("Zahnstangenteilung"),
        deviation("Teilungsabweichung Zahnstange"),
        deviation("Teilungs-Abw. Zahnstange"),
        deviation("Teilungsfehler der Zahnstange"),
    ],
    &[
        open("Schraegungswinkel"),
        deviation("Schrägungswinkelabweichung"),
        deviation("Flankenlinien-Winkelabweichung"),
        deviation("Δβ"),
    ],
    &[open("Radialmaß Ritzel"), deviation("Radialabweichung Ritzel"), deviation("Radialer Messfehler Ritzel")],
    &[
        open("Ritzelteilung"),
        deviation("Teilungsabweichung Ritzel"),
        deviation("Teilungseinzelabweichung Ritzel"),
        deviation("Einzelteilungsabweichung fp Ritzel"),
    ],
    &[deviation("fHβ Ritzel"), deviation("Flankenlinien-Winkelabweichung Ritzel")],
];

const FRENCH: [&[Title]; 6] = [
    &[open("mesure sur rouleau"), open("Cote sur billes"), measured("mesure sur rouleau mesurée")],
    &[open("pas crémaillère"), deviation("erreur de pas crémaillère"), deviation("Écart de pas de la crémaillère")],
    &[open("angle d'hélice"), deviation("écart d'hélice"), deviation("écart d'inclinaison d'hélice")],
    &[open("rayon"), deviation("écart radial pignon")],
    &[open("pas du pignon"), deviation("ecart de pas du pignon"), deviation("Écart de pas individuel pignon")],
    &[deviation("fHβ pignon"), deviation("écart d'inclinaison d'hélice du pignon")],
];

const JAPANESE: [&[Title]; 6] = [
    &[open("オーバーローラー寸法"), open("オーバローラ寸法"), open("オーバーボール径")],
    &[open("ラックピッチ"), deviation("ラックピッチ誤差"), deviation("ラック ピッチ偏差")],
    &[open("ねじれ角"), deviation("リード誤差"), deviation("ねじれ角誤差"), deviation("歯すじ傾斜偏差")],
    &[open("ピニオン半径"), deviation("半径誤差"), deviation("ピニオン半径偏差")],
    &[open("ピニオンピッチ"), deviation("ピニオン単一ピッチ誤差"), deviation("ピニオンピッチ誤差")],
    &[open("ピニオンリード"), deviation("ピニオンリード誤差"), deviation("ピニオン歯すじ傾斜偏差")],
];

impl Language {
    pub const ALL: [Self; 4] = [Self::English, Self::German, Self::French, Self::Japanese];

    pub fn titles(self, kind: DeviationKind) -> &'static [Title] {
        let all = match self {
            Self::English => ENGLISH,
            Self::German => GERMAN,
            Self::French => FRENCH,
            Self::Japanese => JAPANESE,
        };
        all[DeviationKind::ALL.iter().position(|other| *other == kind).unwrap()]
    }

    pub fn part_names(self) -> &'static [&'static str] {
        match self {
            Self::English => &["part_id", "Part No.", "S/N", "Serial number"],
            Self::German => &["Teil", "Teile-Nr.", "Werkstück", "Prüfling Nr."],
            Self::French => &["Numéro de pièce", "N° pièce", "Pièce"],
            Self::Japanese => &["部品番号", "品番", "シリアル番号"],
        }
    }

    pub fn part(self) -> &'static str {
        match self {
            Self::English => "Part",
            Self::German => "Teil",
            Self::French => "Pièce",
            Self::Japanese => "部品",
        }
    }

    /// The column that names the part in a table with a row per characteristic.
    pub fn part_head(self) -> &'static str {
        match self {
            Self::English => "Part ID",
            Self::German => "Teile-Nr.",
            Self::French => "N° pièce",
            Self::Japanese => "部品番号",
        }
    }

    pub fn mean(self) -> &'static str {
        match self {
            Self::English => "Mean",
            Self::German => "Mittelwert",
            Self::French => "Moyenne",
            Self::Japanese => "平均",
        }
    }

    pub fn context(self) -> [Context; 5] {
        match self {
            Self::English => [
                context("Operator", ["Smith", "Jones", "-"]),
                context("Temperature [°C]", ["20.5", "21", "20.875"]),
                context("Date", ["2026-03-12", "2026-03-12", "2026-03-13"]),
                context("Machine", ["CMM 2", "CMM 2", "CMM 3"]),
                context("Remark", ["ok", "checked twice", "n/a"]),
            ],
            Self::German => [
                context("Prüfer", ["Müller", "Meier", "-"]),
                context("Temp. [°C]", ["20,5", "21", "20,875"]),
                context("Datum", ["12.03.2026", "12.03.2026", "13.03.2026"]),
                context("Maschine", ["KMG 2", "KMG 2", "KMG 3"]),
                context("Bemerkung", ["i.O.", "nachgemessen", "k.A."]),
            ],
            Self::French => [
                context("Opérateur", ["Dupont", "Martin", "-"]),
                context("Température [°C]", ["20,5", "21", "20,875"]),
                context("Date", ["12/03/2026", "12/03/2026", "13/03/2026"]),
                context("Machine", ["MMT 2", "MMT 2", "MMT 3"]),
                context("Remarque", ["bon", "mesuré deux fois", "-"]),
            ],
            Self::Japanese => [
                context("測定者", ["田中", "鈴木", "-"]),
                context("温度 [°C]", ["20.5", "21", "20.875"]),
                context("日付", ["2026/03/12", "2026/03/12", "2026/03/13"]),
                context("ロット", ["A2", "A2", "A3"]),
                context("備考", ["良", "再測定", "-"]),
            ],
        }
    }

    pub fn suffixes(self) -> Suffixes {
        match self {
            Self::English => Suffixes {
                nominal: "nominal",
                upper: "upper tolerance",
                lower: "lower tolerance",
                deviation: "deviation",
            },
            Self::German => Suffixes { nominal: "Soll", upper: "OT", lower: "UT", deviation: "Abweichung" },
            Self::French => {
                Suffixes { nominal: "nominal", upper: "tol. sup.", lower: "tol. inf.", deviation: "écart" }
            }
            Self::Japanese => Suffixes { nominal: "設計値", upper: "上限", lower: "下限", deviation: "偏差" },
        }
    }

    pub fn heads(self) -> Heads {
        match self {
            Self::English => Heads {
                name: "Characteristic",
                nominal: "Nominal",
                actual: "Actual",
                deviation: "Deviation",
                upper: "Upper tol.",
                lower: "Lower tol.",
                unit: "Unit",
            },
            Self::German => Heads {
                name: "Merkmal",
                nominal: "Sollwert",
                actual: "Istwert",
                deviation: "Abweichung",
                upper: "Obere Tol.",
                lower: "Untere Tol.",
                unit: "Einheit",
            },
            Self::French => Heads {
                name: "Caractéristique",
                nominal: "Nominal",
                actual: "Mesuré",
                deviation: "Écart",
                upper: "Tol sup",
                lower: "Tol inf",
                unit: "Unité",
            },
            Self::Japanese => Heads {
                name: "測定項目",
                nominal: "設計値",
                actual: "測定値",
                deviation: "誤差",
                upper: "上限",
                lower: "下限",
                unit: "単位",
            },
        }
    }
}
