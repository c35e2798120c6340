use super::*;

/// A heading as `fields aspect holds unit`, each where it says something.
fn understood(text: &str) -> String {
    let Some(heading) = heading(text, &[]) else { return String::new() };
    let keys: Vec<_> = heading.fields.iter().map(|field| field.key()).collect();
    let aspect = match heading.aspect {
        Role::Measured => "",
        Role::Nominal => "nominal",
        Role::Upper => "upper",
        Role::Lower => "lower",
        Role::Uncertainty => "uncertainty",
        other => panic!("{text}: {other:?}"),
    };
    let holds = match heading.holds {
        Some(ValueKind::Deviation) => "deviation",
        Some(ValueKind::Measured) => "measured",
        None => "",
    };
    let unit = heading.unit.unwrap_or_default();
    let words = [keys.join("|"), aspect.to_owned(), holds.to_owned(), unit];
    words.iter().filter(|word| !word.is_empty()).cloned().collect::<Vec<_>>().join(" ")
}

fn check(headings: &[(&str, &str)]) {
    let wrong: Vec<_> = headings
        .iter()
        .map(|(text, expected)| (*text, *expected, understood(text)))
        .filter(|(_, expected, found)| expected != found)
        .map(|(text, expected, found)| format!("{text}: {found}, not {expected}"))
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

fn keys(fields: &[Field]) -> String {
    fields.iter().map(|field| field.key()).collect::<Vec<_>>().join("|")
}

#[test]
fn every_key_means_its_field() {
    for field in Field::ALL {
        let expected = match field {
            Field::Radial => Field::Error(DeviationKind::PinionRadial),
            Field::Lead => Field::Error(DeviationKind::RackLead),
            field => field,
        };
        assert_eq!(heading(field.key(), &[]).map(|heading| heading.fields), Some(vec![expected]), "{}", field.key());
    }
}

#[test]
fn english_headings() {
    check(&[
        ("rack_over_roller", "rack_over_roller"),
        ("Rack over roller [mm]", "rack_over_roller mm"),
        ("rackOverRoller", "rack_over_roller"),
        ("RACK OVER ROLLER MM", "rack_over_roller MM"),
        ("Measurement over roller(s) (mm)", "rack_over_roller mm"),
        ("M [mm]", "rack_over_roller mm"),
        ("Rack over-roller measurement M (mm)", "rack_over_roller measured mm"),
        ("Ｍ（ｍｍ）", "rack_over_roller mm"),
        ("dp [µm]", "rack_pitch deviation µm"),
        ("Teilungsabw. Zahnstange fp", "rack_pitch deviation"),
        ("fp [µm]", "rack_pitch|pinion_pitch deviation µm"),
        ("Rollenmaß 25±0,03 [mm]", "rack_over_roller mm"),
        ("Δp / µm", "rack_pitch deviation µm"),
        ("lead (deg)", "rack_lead deg"),
        ("lead error [min]", "rack_lead deviation min"),
        ("Lead angle deviation, rack [arcmin]", "rack_lead deviation arcmin"),
        ("Pitch", "rack_pitch|pinion_pitch"),
        ("pitch /µm", "rack_pitch|pinion_pitch µm"),
        ("pitch (micron)", "rack_pitch|pinion_pitch micron"),
        ("rack pitch [1/1000 mm]", "rack_pitch 1/1000 mm"),
        ("rack pitch [parsec]", "rack_pitch parsec"),
        ("rack pitch error", "rack_pitch deviation"),
        ("RackPitch", "rack_pitch"),
        ("rackpitch", "rack_pitch"),
        ("Pitch error of rack", "rack_pitch deviation"),
        ("003 Pitch error of rack", "rack_pitch deviation"),
        ("#4 fp", "rack_pitch|pinion_pitch deviation"),
        ("4) rack pitch", "rack_pitch"),
        ("1.2 rack pitch", "rack_pitch"),
        ("axial pitch deviation (um)", "rack_pitch deviation um"),
        ("f_p [um]", "rack_pitch|pinion_pitch deviation um"),
        ("f p", "rack_pitch|pinion_pitch deviation"),
        ("fpt", "rack_pitch|pinion_pitch deviation"),
        ("pitch deviation, pinion, single", "pinion_pitch deviation"),
        ("F_pt", "rack_pitch|pinion_pitch deviation"),
        ("single pitch deviation fpt pinion", "pinion_pitch deviation"),
        ("max. single pitch deviation pinion", "pinion_pitch deviation"),
        ("pinion_radial_mm", "pinion_radial mm"),
        ("radial error", "pinion_radial deviation"),
        ("Pinion radial measurement error", "pinion_radial deviation"),
        ("Rack No.", "part_id"),
        ("Δr", "pinion_radial deviation"),
        ("over_pin_deviation [um]", "over_pin deviation um"),
        ("Measurement over pins", "over_pin"),
        ("space no.", "space"),
        ("Tooth #", "tooth"),
        ("tooth number", "tooth"),
        ("left_pitch_deviation", "left_pitch deviation"),
        ("fp LF [µm]", "left_pitch deviation µm"),
        ("pitch, right flank", "right_pitch"),
        ("Part No.", "part_id"),
        ("P/N", "part_id"),
        ("S/N", "part_id"),
        ("Serial number", "part_id"),
        ("part pitch", "rack_pitch|pinion_pitch"),
        ("Position (Ist) [mm]", "position measured mm"),
        ("fHβ [µm]", "rack_lead deviation µm"),
        ("f_Hβ", "rack_lead deviation"),
        ("f_H beta", "rack_lead deviation"),
        ("fHb", "rack_lead deviation"),
        ("F_Hbeta", "rack_lead deviation"),
        ("fHß", "rack_lead deviation"),
        ("helix slope deviation", "rack_lead deviation"),
        ("rack fHβ (um)", "rack_lead deviation um"),
        ("pinion lead", "pinion_lead"),
        ("pinion lead error (um)", "pinion_lead deviation um"),
        ("pinion fHβ [µm]", "pinion_lead deviation µm"),
        ("helix slope deviation of the pinion", "pinion_lead deviation"),
        ("fHb pinion", "pinion_lead deviation"),
    ]);
}

#[test]
fn german_headings() {
    check(&[
        ("Rollenmaß [mm]", "rack_over_roller mm"),
        ("Rollenmass", "rack_over_roller"),
        ("ROLLENMAẞ", "rack_over_roller"),
        ("Rollenmaß/µm", "rack_over_roller µm"),
        ("Rollenmaß:", "rack_over_roller"),
        ("Rollenmaß =", "rack_over_roller"),
        ("12. Rollenmaß", "rack_over_roller"),
        ("Pos. 3 Rollenmaß", "rack_over_roller"),
        ("Nr. 7: Rollenmaß", "rack_over_roller"),
        ("Maß über Rolle", "rack_over_roller"),
        ("Mass ueber Rolle", "rack_over_roller"),
        ("Mass uber Rolle", "rack_over_roller"),
        ("Maß u\u{308}ber Rolle", "rack_over_roller"),
        ("Kugelmaß-Abweichung (µm)", "rack_over_roller deviation µm"),
        ("Rollenmaßabweichung", "rack_over_roller deviation"),
        ("Stiftmaß", "over_pin"),
        ("Abweichung über Stift [µm]", "over_pin deviation µm"),
        ("Schrägungswinkelabweichung [°]", "rack_lead deviation °"),
        ("Schraegungswinkel°", "rack_lead °"),
        ("Flankenlinien-Winkelabweichung", "rack_lead deviation"),
        ("Flankenlinienwinkelabweichung Zahnstange", "rack_lead deviation"),
        ("Flankenlinien-Winkelabweichung Ritzel", "pinion_lead deviation"),
        ("Ritzel fHβ [µm]", "pinion_lead deviation µm"),
        ("f_Hβ Ritzel", "pinion_lead deviation"),
        ("Δβ:", "rack_lead deviation"),
        ("Teilungsabweichung Zahnstange [µm]", "rack_pitch deviation µm"),
        ("Teilungs-Abw. Zahnstange", "rack_pitch deviation"),
        ("Teilungsabw. Zst.", "rack_pitch deviation"),
        ("Zahnstangenteilung", "rack_pitch"),
        ("Zahnstangenteilungsabweichung", "rack_pitch deviation"),
        ("Teilungsfehler der Zahnstange", "rack_pitch deviation"),
        ("Teilungsabweichung Ritzel in µm", "pinion_pitch deviation µm"),
        ("Teilungseinzelabweichung Ritzel", "pinion_pitch deviation"),
        ("Einzelteilungsabweichung fp", "rack_pitch|pinion_pitch deviation"),
        ("Ritzelteilung", "pinion_pitch"),
        ("Radialmaß Ritzel", "pinion_radial"),
        ("Radialabweichung Ritzel", "pinion_radial deviation"),
        ("Radialer Messfehler Ritzel", "pinion_radial deviation"),
        ("Zahnst. Rollenmaß", "rack_over_roller"),
        ("ΔM [µm]", "rack_over_roller deviation µm"),
        ("fp links [µm]", "left_pitch deviation µm"),
        ("fp re.", "right_pitch deviation"),
        ("Teilung rechte Flanke", "right_pitch"),
        ("Lücke", "space"),
        ("Zahnluecke", "space"),
        ("Lückenlage", "position"),
        ("Zahn-Nr.", "tooth"),
        ("Teile-Nr.", "part_id"),
        ("Werkstück", "part_id"),
        ("Lfd. Nr.", "part_id"),
        ("Abweichung vom Nennmaß Rollenmaß", "rack_over_roller deviation"),
    ]);
}

#[test]
fn french_headings() {
    check(&[
        ("mesure sur rouleau [mm]", "rack_over_roller mm"),
        ("Cote sur billes", "rack_over_roller"),
        ("mesure sur piges", "over_pin"),
        ("erreur de pas", "rack_pitch|pinion_pitch deviation"),
        ("erreur de pas crémaillère [µm]", "rack_pitch deviation µm"),
        ("Écart de pas de la crémaillère (µm)", "rack_pitch deviation µm"),
        ("E\u{301}cart de pas individuel pignon", "pinion_pitch deviation"),
        ("ecart de pas du pignon en µm", "pinion_pitch deviation µm"),
        ("pas du flanc gauche", "left_pitch"),
        ("écart de pas droite", "right_pitch deviation"),
        ("hélice", "rack_lead"),
        ("angle d'hélice [°]", "rack_lead °"),
        ("écart d’hélice", "rack_lead deviation"),
        ("écart d'inclinaison d'hélice", "rack_lead deviation"),
        ("écart d'inclinaison d'hélice du pignon", "pinion_lead deviation"),
        ("fHβ pignon", "pinion_lead deviation"),
        ("rayon", "pinion_radial"),
        ("écart radial pignon", "pinion_radial deviation"),
        ("numéro de dent", "tooth"),
        ("N° dent", "tooth"),
        ("creux", "space"),
        ("entredent", "space"),
        ("Numéro de pièce", "part_id"),
        ("N° pièce", "part_id"),
        ("mesure sur rouleau nominal", "rack_over_roller nominal"),
        ("mesure sur rouleau mesurée", "rack_over_roller measured"),
        ("pas crémaillère tol. sup.", "rack_pitch upper"),
    ]);
}

#[test]
fn japanese_headings() {
    check(&[
        ("オーバーローラー寸法[mm]", "rack_over_roller mm"),
        ("オーバローラ寸法", "rack_over_roller"),
        ("オーバーボール径（mm）", "rack_over_roller mm"),
        ("ラックオーバーピン径", "over_pin"),
        ("ラックピッチ誤差［μm］", "rack_pitch deviation μm"),
        ("ラック ピッチ偏差", "rack_pitch deviation"),
        ("ラックのピッチ誤差μm", "rack_pitch deviation μm"),
        ("ﾗｯｸﾋﾟｯﾁ誤差", "rack_pitch deviation"),
        ("ピニオン単一ピッチ誤差【µm】", "pinion_pitch deviation µm"),
        ("ピッチ誤差", "rack_pitch|pinion_pitch deviation"),
        ("左歯面ピッチ誤差", "left_pitch deviation"),
        ("ピッチ誤差（右歯面）", "right_pitch deviation"),
        ("リード誤差", "rack_lead deviation"),
        ("ねじれ角誤差[分]", "rack_lead deviation 分"),
        ("歯すじ方向誤差", "rack_lead deviation"),
        ("歯すじ傾斜偏差", "rack_lead deviation"),
        ("ピニオン歯すじ傾斜偏差", "pinion_lead deviation"),
        ("ピニオンリード誤差", "pinion_lead deviation"),
        ("半径誤差", "pinion_radial deviation"),
        ("ピニオン半径偏差", "pinion_radial deviation"),
        ("歯番号", "tooth"),
        ("歯溝番号", "space"),
        ("溝", "space"),
        ("部品番号", "part_id"),
        ("シリアル番号", "part_id"),
        ("品番", "part_id"),
        ("オーバーピン径 設計値", "over_pin nominal"),
        ("オーバーピン径実測値", "over_pin measured"),
        ("ラックピッチ 上限", "rack_pitch upper"),
        ("オーバーピン径下限公差", "over_pin lower"),
    ]);
}

#[test]
fn what_a_column_says_of_its_field() {
    check(&[
        ("Rollenmaß Soll", "rack_over_roller nominal"),
        ("Rollenmaß (Soll) [mm]", "rack_over_roller nominal mm"),
        ("Soll-Rollenmaß", "rack_over_roller nominal"),
        ("Nennmaß Rolle", "rack_over_roller nominal"),
        ("rack_over_roller nominal [mm]", "rack_over_roller nominal mm"),
        ("rack_over_roller_nominal", "rack_over_roller nominal"),
        ("Teilungsabweichung Zahnstange Soll", "rack_pitch nominal deviation"),
        ("Rollenmaß Ist", "rack_over_roller measured"),
        ("Rollenmaß Istwert", "rack_over_roller measured"),
        ("rack over roller actual", "rack_over_roller measured"),
        ("Rollenmaß Ist-Soll", "rack_over_roller deviation"),
        ("Rollenmaß Soll-Ist", ""),
        ("M OT", "rack_over_roller upper"),
        ("M UT", "rack_over_roller lower"),
        ("upper tolerance rack pitch", "rack_pitch upper"),
        ("rack_pitch_upper_tol", "rack_pitch upper"),
        ("Rollenmaß USL", "rack_over_roller upper"),
        ("Rollenmaß UTG", "rack_over_roller lower"),
        ("Rollenmaß OTG [mm]", "rack_over_roller upper mm"),
        ("Rollenmaß Obere Tol.", "rack_over_roller upper"),
        ("Rollenmaß unteres Abmaß", "rack_over_roller lower"),
        ("rack pitch lower limit", "rack_pitch lower"),
        ("rack pitch +Tol", "rack_pitch upper"),
        ("rack pitch Tol -", "rack_pitch lower"),
        ("Rollenmaß T+", "rack_over_roller upper"),
        ("Rollenmaß T-", "rack_over_roller lower"),
        ("- Tol. rack pitch", "rack_pitch lower"),
        ("Result rack pitch", "rack_pitch measured"),
        ("rack pitch ±Tol", "rack_pitch upper"),
        ("rack pitch tolerance", "rack_pitch upper"),
        ("Rollenmaß Höchstmaß", "rack_over_roller upper"),
        ("U(k=2) Rollenmaß", "rack_over_roller uncertainty"),
        ("Rollenmaß U (k = 2) [µm]", "rack_over_roller uncertainty µm"),
        ("rack_pitch U", "rack_pitch uncertainty"),
        ("Messunsicherheit Rollenmaß", "rack_over_roller uncertainty"),
        ("rack over roller uncertainty (um)", "rack_over_roller uncertainty um"),
        ("Rollenmaß ±", "rack_over_roller uncertainty"),
        ("- Rollenmaß", "rack_over_roller"),
        ("-Rollenmaß", "rack_over_roller"),
    ]);
}

#[test]
fn what_is_no_heading_or_says_too_little() {
    check(&[
        ("Hallo Herr Meier", ""),
        ("Temperatur [°C]", ""),
        ("Temperatur Zahnstange", ""),
        ("rack_pich [um]", ""),
        ("pitch limit", ""),
        ("pitch diameter", ""),
        ("pitch no.", ""),
        ("rack_pitch_m", ""),
        ("lead_in [mm]", ""),
        ("dM [mm]", ""),
        ("Serial pitch", ""),
        ("status rack pitch", ""),
        ("Zahnrichtungsfehler", ""),
        ("Rollenmaß max", ""),
        ("Rollenmaß min", ""),
        ("Rollenmaß 2", ""),
        ("2-Kugelmaß", ""),
        ("upper lower rack pitch", ""),
        ("fp Zahnstange links", ""),
        ("Fp [µm]", ""),
        ("F_p Ritzel", ""),
        ("Fβ", ""),
        ("pinion helix angle", ""),
        ("Schrägungswinkel Ritzel", ""),
        ("Δβ pinion", ""),
        ("Fβ Ritzel", ""),
        ("over pin pinion", ""),
        ("radial runout", ""),
        ("Soll", ""),
        ("Ist", ""),
        ("OT", ""),
        ("part error", ""),
        ("Zahn Soll", ""),
        ("Roller diameter [mm]", ""),
        ("Pass", ""),
        ("Number of teeth", ""),
        ("Merkmal", ""),
        ("Teil 1", ""),
        ("", ""),
        ("[mm]", ""),
    ]);
}

#[test]
fn the_specs_own_names_win() {
    let own = [
        ("MyRoll".to_owned(), Field::Error(DeviationKind::RackOverRoller)),
        ("Pitch [µm]".to_owned(), Field::Error(DeviationKind::RackPitch)),
        ("Temperatur".to_owned(), Field::Error(DeviationKind::PinionRadial)),
    ];
    for (text, expected) in [
        ("myroll", "rack_over_roller"),
        (" MyRoll [mm] ", "rack_over_roller mm"),
        ("MyRoll_um", "rack_over_roller um"),
        ("pitch [µm]", "rack_pitch µm"),
        ("Pitch", "rack_pitch"),
        ("TEMPERATUR", "pinion_radial"),
        ("My Roll", ""),
    ] {
        let found = heading(text, &own).map_or_else(String::new, |heading| {
            let unit = heading.unit.map_or_else(String::new, |unit| format!(" {unit}"));
            format!("{}{unit}", keys(&heading.fields))
        });
        assert_eq!(found, expected, "{text}");
    }
}

#[test]
fn short_names_of_every_language() {
    check(&[
        ("Rollenmaß", "rack_over_roller"),
        ("M Soll", "rack_over_roller nominal"),
        ("erreur de pas", "rack_pitch|pinion_pitch deviation"),
        ("Zahn", "tooth"),
        ("rack pitch", "rack_pitch"),
        ("radial", "pinion_radial"),
        ("position", "position"),
        ("リード誤差", "rack_lead deviation"),
    ]);
}

#[test]
fn names_that_are_near_known_ones() {
    for (text, expected) in [
        ("rack_pich [um]", "rack_pitch"),
        ("rackpich", "rack_pitch"),
        ("rack_ptich", "rack_pitch"),
        ("pitch [um]", "rack_pitch|pinion_pitch"),
        ("erreur de pas", "rack_pitch|pinion_pitch"),
        ("fp Zahnstange links", "rack_pitch"),
        ("Teilungsabw. Zahnstange fp 2", "rack_pitch"),
        ("Teilungsabw. Zahnstange fp", "rack_pitch"),
        ("pinon pitch", "pinion_pitch"),
        ("rack over rolle", "rack_over_roller"),
        ("rack ovr roller", "rack_over_roller"),
        ("rack_over_rollr", "rack_over_roller"),
        ("Rolenmaß", "rack_over_roller"),
        ("Rollemaß Ist", "rack_over_roller"),
        ("Rollenmaß 2", "rack_over_roller"),
        ("Rollenmaß max", "rack_over_roller"),
        ("Rollenmaß (oben, Seite A)", "rack_over_roller"),
        ("Kuglmaß", "rack_over_roller"),
        ("Stiftmas", "over_pin"),
        ("Teilug", "rack_pitch|pinion_pitch"),
        ("Teilugsabweichung Zahnstange", "rack_pitch"),
        ("pitch limit", "rack_pitch|pinion_pitch"),
        ("pitch diameter", "rack_pitch|pinion_pitch"),
        ("Fp", "rack_pitch|pinion_pitch"),
        ("Summenteilungsabweichung Fp Ritzel", "pinion_pitch"),
        ("Ritzel fHβ", "pinion_lead"),
        ("Ritzel fHβ Mittel", "pinion_lead"),
        ("Schrägungswinkel Ritzel", "rack_lead"),
        ("lead crowning", "rack_lead"),
        ("Schraegungswinkl", "rack_lead"),
        ("helx angle", "rack_lead"),
        ("Fβ", "rack_lead"),
        ("pinion radail", "pinion_radial"),
        ("radial runout", "pinion_radial"),
        ("Rundlaufabweichung", "pinion_radial"),
        ("faux-rond radial", "pinion_radial"),
        ("over pin pinion", "over_pin"),
        ("roler", "rack_over_roller"),
        ("ピッチ円直径", "rack_pitch|pinion_pitch"),
        ("ラックピッチ誤差その2", "rack_pitch"),
        ("cremaillere erreur de pass", ""),
        ("M2", "rack_over_roller"),
        ("p limit", "rack_pitch|pinion_pitch"),
        ("lead_in [mm]", "rack_lead"),
        ("dM", "rack_over_roller"),
        ("Zahnrichtungsfehler", "rack_lead"),
        ("Stirnteilung Zahnstange", "rack_pitch"),
        ("rack_pitch_m", "rack_pitch"),
        ("spce", "space"),
        ("positon", "position"),
    ] {
        assert_eq!(keys(&near(text)), expected, "{text}");
    }
}

#[test]
fn ordinary_columns_are_near_nothing() {
    let context = "Datum|Date|Uhrzeit|Prüfer|Operator|Machine|Maschine|Serie|Charge|Batch|Lot|Line|Linie|Temperature|\
                   Temp. [°C]|Kraft [N]|Bemerkung|Comment|Remark|Status|Result|Ergebnis|Shift|Schicht|Time|Zeit|Station|\
                   Gauge|Count|Anzahl|Teil|Part|Ist|Soll|OT|UT|Nominal|Deviation|Abweichung|Error|Rack|Zahnstange|Pinion|\
                   Left|rechts|Value|Wert|Max|Unit|Merkmal|Feature|Load|Lead time|Leak rate|Head|Spare|Abteilung|Verteilung|\
                   Heizung|Lager|Pass|Patch|Zahl|Batch no.|Lot 7|Operator 2|Modul|Serial number|Teile-Nr.|Humidity [%]|\
                   Pressure|Torque [Nm]|Härte|Hardness HRC|Spindle|Palette|Prüfplan|Zeichnungsnummer|Auftrag|Kunde|Index|\
                   Cycle time [s]|Measured by|Inspector|Gruppe|Mitarbeiter|Name|Vorname|Straße|Ort|Land|Weight [kg]|\
                   Messdatum|Timestamp|Year|Monat|Équipe|Opérateur|Heure|Pièce|Remarque|日付|測定者|温度|備考|ロット|判定|\
                   Rz|Wall|Depth|Höhe|Breite|Flatness|Ebenheit|Rechtwinkligkeit|Parallelität|Rauheit|Bohrung|Gewinde|\
                   Diameter|Durchmesser|Length|Länge|Angle|Winkel|Distance|Abstand|Cylinder|Concentricity|Hole 1|Bore|Kante|Overall|Tool position|\
                   Position operator|Roller temp.|Zahndicke|Tooth width|Tooth index|Mitteilung|Beurteilung|Radial force|\
                   Rack length [mm]|Track|Place|Composition|Cpk|Profil|fHα|Ø|管理番号|工具|材質";
    let wrong: Vec<_> = context.split('|').filter(|text| !near(text).is_empty()).collect();
    assert!(wrong.is_empty(), "{wrong:?}");
}

#[test]
fn context_is_known() {
    for text in [
        "Date",
        "Messdatum",
        "Uhrzeit",
        "Operator",
        "Prüfer:",
        "Operator ID",
        "Maschinen-Nr.",
        "Serial no.",
        "Temp. [°C]",
        "Temperatur Zahnstange",
        "Temperature 2",
        "Status",
        "Bemerkung",
        "module",
        "Modul",
        "モジュール",
        "pressure angle [deg]",
        "Eingriffswinkel",
        "圧力角",
        "Number of teeth",
        "Zähnezahl",
        "歯数",
        "face width [mm]",
        "Zahnbreite [mm]",
        "Roller diameter [mm]",
        "Rollendurchmesser [mm]",
        "measuring_pin_diameter_mm",
        "ball diameter",
        "tip diameter",
        "Kopfkreisdurchmesser [mm]",
        "evaluation length [mm]",
        "Auswertelänge",
        "Toleranzklasse",
        "Diamètre de pige",
        "003 Modul",
    ] {
        assert!(is_context(text), "{text}");
    }
    for text in
        ["pitch", "Rollenmaß", "rack_pich", "pin temperature", "Soll", "Flatness", "length [mm]", "Ra [µm]", "", "12"]
    {
        assert!(!is_context(text), "{text}");
    }
}

#[test]
fn roles_of_tables_with_a_row_per_characteristic() {
    use Role::{Deviation, Lower, Measured, Name, Nominal, Part, Status, Uncertainty, Unit, Upper};
    for (headings, roles) in [
        ("partnb id actual nominal uppertol lowertol", vec![Part, Name, Measured, Nominal, Upper, Lower]),
        ("Merkmal Soll Ist Abw. OT UT", vec![Name, Nominal, Measured, Deviation, Upper, Lower]),
        (
            "Bezeichnung;Nennmaß;Istmaß;Obere Tol.;Untere Tol.;Abweichung",
            vec![Name, Nominal, Measured, Upper, Lower, Deviation],
        ),
        ("Feature;NOMINAL;MEAS;+TOL;-TOL;DEV;OUTTOL", vec![Name, Nominal, Measured, Upper, Lower, Deviation, Status]),
        ("Caractéristique;Nominal;Mesuré;Écart;Tol+;Tol-", vec![Name, Nominal, Measured, Deviation, Upper, Lower]),
        ("Désignation;Théorique;Réel;Tol sup;Tol inf;Unité", vec![Name, Nominal, Measured, Upper, Lower, Unit]),
        (
            "測定項目;設計値;測定値;誤差;上限;下限;単位;判定",
            vec![Name, Nominal, Measured, Deviation, Upper, Lower, Unit, Status],
        ),
        ("項目;基準値;実測値;偏差;上限公差;下限公差", vec![Name, Nominal, Measured, Deviation, Upper, Lower]),
        (
            "Element;Nominal;Actual;Tol -;Tol +;Dev.;Check",
            vec![Name, Nominal, Measured, Lower, Upper, Deviation, Status],
        ),
        (
            "Part ID;Characteristic;Nominal value [mm];Measured value [mm];Deviation;Upper limit;Lower limit",
            vec![Part, Name, Nominal, Measured, Deviation, Upper, Lower],
        ),
        (
            "Teile-Nr.;Prüfmerkmal;Sollwert;Istwert;OTG;UTG;Einheit",
            vec![Part, Name, Nominal, Measured, Upper, Lower, Unit],
        ),
        ("Merkmal;Nennwert;oberes Abmaß;unteres Abmaß;Messwert", vec![Name, Nominal, Upper, Lower, Measured]),
        (
            "Name;Ist-Maß;Soll-Maß;OGW;UGW;Toleranz;U (k=2)",
            vec![Name, Measured, Nominal, Upper, Lower, Upper, Uncertainty],
        ),
        ("Rack No.;Label;Nom.;Act.;+ Tol.;- Tol.;Out", vec![Part, Name, Nominal, Measured, Upper, Lower, Status]),
        ("Name;Nennm.;Istm.;T+;T-;UpTol;LoTol", vec![Name, Nominal, Measured, Upper, Lower, Upper, Lower]),
        ("Item;Design;Value;USL;LSL;Error;Judgement", vec![Name, Nominal, Measured, Upper, Lower, Deviation, Status]),
        ("Werkstück;Größe;Ist-Soll;Max;Min;Messunsicherheit", vec![Part, Name, Deviation, Upper, Lower, Uncertainty]),
    ] {
        let headings: Vec<_> = headings.split(if headings.contains(';') { ';' } else { ' ' }).collect();
        let found: Vec<_> = headings.iter().map(|heading| role(heading)).collect();
        assert_eq!(found, roles.into_iter().map(Some).collect::<Vec<_>>(), "{headings:?}");
    }
    for text in
        ["Teil 1", "Part 2", "Pièce 3", "Messung 1", "Nr.", "#", "Bemerkung", "Rollenmaß", "rack pitch", "Soll-Ist", ""]
    {
        assert_eq!(role(text), None, "{text}");
    }
}

proptest::proptest! {
    #[test]
    fn any_text_is_taken(text in "(\\PC|[ _/()\\[\\]+µ°ßü\u{308}ﾞｶ．（-]|Teilung|pitch|Tol){0,24}") {
        let _ = (heading(&text, &[]), near(&text), role(&text), is_context(&text), split_unit(&text));
    }

    #[test]
    fn case_blanks_and_marks_tell_nothing(index in 0..14_usize, upper: bool, joint in "[ _-]") {
        let key = Field::ALL[index].key();
        let text = key.replace('_', &joint);
        let text = if upper { text.to_uppercase() } else { text };
        proptest::prop_assert_eq!(heading(&text, &[]), heading(key, &[]));
    }
}
