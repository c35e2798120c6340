//! The keys of `[table]`, the contract of tables.

use super::entry::{COLUMN_KIND, COLUMN_MEASURED_AT, COLUMN_NAME, EVALUATION_LENGTH, column_extent};
use super::kind::{AnyKey, Key, Kind, Section, key, of, section, text, word};
use crate::deviation::Countable;

/// The keys that name columns beside that of an error's values, with what they hold.
pub(crate) const BESIDE: [&str; 5] = ["deviation", "upper", "lower", "uncertainty", "units"];

const fn beside(name: &'static str, doc: &'static str) -> AnyKey {
    key(name, Kind::Text, doc)
}

/// The keys of a column of the contract, whose errors may have these extents.
const fn table_column(of: Countable, is_lead: bool) -> [AnyKey; 10] {
    [
        COLUMN_NAME.any,
        key("unit", Kind::ColumnUnit { of_lead: is_lead }, "Unit of its numbers, if its heading says none."),
        key(
            "nominal",
            Kind::NominalOrHeading { is_angle: is_lead },
            "Nominal value of what was measured, or the heading of a column of them.",
        ),
        beside("deviation", "Heading of a column of deviations, held against measured less nominal."),
        beside("upper", "Heading of a column of upper limits, not judged."),
        beside("lower", "Heading of a column of lower limits, not judged."),
        beside("uncertainty", "Heading of a column of uncertainties, not judged."),
        beside("units", "Heading of a column of units."),
        COLUMN_KIND.any,
        column_extent(of),
    ]
}

/// The keys of a column with one key more.
const fn and_key(keys: &[AnyKey; 10], last: AnyKey) -> [AnyKey; 11] {
    let mut all = [last; 11];
    let mut at = 0;
    while at < keys.len() {
        all[at] = keys[at];
        at += 1;
    }
    all
}

const TABLE_SIZE: Section =
    section("table.columns.(size)", "A column of sizes.", &table_column(Countable::Space, false));
const TABLE_PITCH: Section =
    section("table.columns.rack_pitch", "A column of pitches.", &table_column(Countable::Pitch, false));
const TABLE_PINION_PITCH: Section = section(
    "table.columns.pinion_pitch",
    "A column of the pinion's single pitch deviations.",
    &and_key(&table_column(Countable::Pitch, false), COLUMN_MEASURED_AT.any),
);
const TABLE_SLOPE: Section = section(
    "table.columns.pinion_lead",
    "A column of helix slope deviations f_Hβ.",
    &table_column(Countable::Tooth, false),
);
const TABLE_ANGLE: Section = section(
    "table.columns.rack_lead",
    "A column of angles, or of helix slope deviations f_Hβ.",
    &and_key(&table_column(Countable::Tooth, true), EVALUATION_LENGTH.any),
);

pub(crate) const TABLE_TOOTH: Section = section(
    "table.columns.(space or tooth)",
    "A column of spaces or teeth.",
    &[
        COLUMN_NAME.any,
        key("unit", Kind::ColumnUnit { of_lead: true }, "Unit of its numbers, if its heading says none."),
        COLUMN_KIND.any,
    ],
);

pub(crate) const TABLE_TRACE: Section = section(
    "table.columns.(stroke or ΔCD)",
    "A column of a measured curve.",
    &[
        COLUMN_NAME.any,
        key("unit", Kind::ColumnUnit { of_lead: false }, "Unit of its numbers, if its heading says none."),
    ],
);

pub(crate) const TABLE_STATUS: Section = section(
    "table.columns.status",
    "The decision of a measuring program: a part whose text is neither accepted nor rejected has no verdict.",
    &[
        COLUMN_NAME.any,
        key("accept", Kind::Texts, "Texts of parts that are judged by their values."),
        key("reject", Kind::Texts, "Texts of parts that fail."),
    ],
);

pub(crate) const TABLE_COLUMNS: Section = section(
    "table.columns",
    "What the columns of a table are, whose headings do not say it by themselves.",
    &[
        key(
            "part_id",
            Kind::PartId,
            "Heading of the column that names the part, or { line = \"Part: *\" } for a line above its rows.",
        ),
        key("status", Kind::Table(&TABLE_STATUS), "The column of the measuring program's decision."),
        key("rack_over_roller", Kind::Table(&TABLE_SIZE), "The rack's over-roller measure or error."),
        key("rack_pitch", Kind::Table(&TABLE_PITCH), "The rack's pitch or pitch error."),
        key("rack_lead", Kind::Table(&TABLE_ANGLE), "The rack's lead angle, its error, or f_Hβ."),
        key("pinion_radial", Kind::Table(&TABLE_SIZE), "The pinion's radial measure or error."),
        key("pinion_pitch", Kind::Table(&TABLE_PINION_PITCH), "The pinion's single pitch deviation."),
        key("pinion_lead", Kind::Table(&TABLE_SLOPE), "The pinion's helix slope deviation f_Hβ."),
        key("date", Kind::Text, "Heading of dates, for pages."),
        key("inspector", Kind::Text, "Heading of inspectors."),
        key("order", Kind::Text, "Heading of orders."),
        key("drawing", Kind::Text, "Heading of drawings."),
        key("name", Kind::Text, "Of characteristics: heading of the column of their names."),
        key("actual", Kind::Text, "Heading of the column of measured values."),
        key("nominal", Kind::Text, "Heading of the column of nominal values."),
        key("upper", Kind::Text, "Heading of the column of upper limits, not judged."),
        key("lower", Kind::Text, "Heading of the column of lower limits, not judged."),
        key("deviation", Kind::Text, "Heading of the column of deviations."),
        key("uncertainty", Kind::Text, "Heading of the column of uncertainties, not judged."),
        key("unit", Kind::Text, "Heading of the column of units."),
        key("space", Kind::Text, "Of a rack's spaces: heading of the column of their numbers."),
        key("tooth", Kind::Text, "Of a pinion's teeth: heading of the column of their numbers."),
        key("over_pin", Kind::Table(&TABLE_TOOTH), "The measure over the pin in a space, or its deviation."),
        key("position", Kind::Table(&TABLE_TOOTH), "The position of the pin in a space, or its deviation."),
        key("radial", Kind::Table(&TABLE_TOOTH), "The radial deviation of the space behind a tooth."),
        key("left_pitch", Kind::Table(&TABLE_TOOTH), "The single pitch deviation of a tooth's left flank."),
        key("right_pitch", Kind::Table(&TABLE_TOOTH), "The single pitch deviation of a tooth's right flank."),
        key("lead", Kind::Table(&TABLE_TOOTH), "The helix angle deviation of a space or tooth."),
        key("stroke", Kind::Table(&TABLE_TRACE), "Of a measured curve: the stroke."),
        key("delta_cd", Kind::Table(&TABLE_TRACE), "Of a measured curve: ΔCD."),
    ],
);

/// The keys of `[table.columns]` that are headings.
pub(crate) const HEADINGS: [&str; 10] =
    ["name", "actual", "nominal", "upper", "lower", "deviation", "uncertainty", "unit", "space", "tooth"];

section! {
    TABLE = "table", "The contract of tables with values of parts." {
        "columns", of(Kind::Table(&TABLE_COLUMNS)), "What columns are, whose headings do not say it by themselves.";
        TABLE_PARTS: &'static str = "parts", word(&["rows", "columns", "characteristics", "spaces", "teeth"]),
            "What each row is, or columns if each part is one. Default: found from the headings.";
        TABLE_DECIMAL: &'static str = "decimal", word(&["comma", "point"]),
            "What stands before decimals. Default: the only mark by which every number can be read.";
        TABLE_SEPARATOR: String = "separator", text(),
            "What separates cells: a character, or tab. Default: the only one under which the headings are known.";
        TABLE_ENCODING: String = "encoding", text(),
            "The encoding of a text, such as windows-1252. Default: told by its bytes.";
        TABLE_SHEET: String = "sheet", text(), "The sheet of a workbook. Default: the only one with cells.";
        TABLE_RANGE: String = "range", text(), "The cells of a sheet that are the table, such as B4:F200. Default: all.";
        "ignore", of(Kind::Texts),
            "Headings of columns that are not used: `*` stands for any characters, and case counts.";
        "ignore_lines", of(Kind::LineRules),
            "Lines that belong to no part: `#` stands for a number or a date, too; cells stand between semicolons.";
        "comments", of(Kind::Texts), "Comments, text boxes and metadata of a file that are not used.";
        TABLE_OTHERS: &'static str = "others", word(&["ignore"]), "Every further column is not used.";
        TABLE_REPEATS: &'static str = "repeats", word(&["all", "last"]),
            "A part may be there more than once: each row is judged, or the last.";
        TABLE_UNITS: String = "units", text(),
            "The line of units, such as \"line 8\". Default: the one below the headings, if it has nothing but units.";
        "starts", of(Kind::Starts),
            "In which column of characters each cell of a text of fixed width starts: [0, 12, 24].";
    }
}
