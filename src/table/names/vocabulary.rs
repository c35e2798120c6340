//! The words of headings and labels in English, German, French and Japanese, and what each can mean. A list of words:
//! what they mean together is told elsewhere.

use std::collections::HashMap;
use std::sync::LazyLock;

use super::words::fold;
use super::{Field, Role};
use crate::deviation::DeviationKind;

/// What a word can mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sense {
    /// It names what is measured.
    Name(&'static [Field]),
    /// It names what is measured, and that as a deviation.
    Error(&'static [Field]),
    /// It names what is measured where no other word does.
    Alone(&'static [Field]),
    /// Something else that is easily taken for it.
    Near(&'static [Field]),
    Rack,
    Pinion,
    Left,
    Right,
    Deviation,
    Measured,
    Nominal,
    Upper,
    Lower,
    Plus,
    Minus,
    Tolerance,
    /// A tolerance if it is said which side.
    Limit,
    Uncertainty,
    Greatest,
    Least,
    /// It changes nothing.
    Filling,
    /// What no error is called.
    Context,
    /// It looks like a known word and is none.
    Other,
    /// What a column of a table with a row per characteristic is called.
    Role(Role),
    /// The number of a line or of a part.
    Ordinal,
    Number,
}

impl Sense {
    /// Whether a heading with such a word names no field.
    pub(super) const fn is_foreign(self) -> bool {
        matches!(
            self,
            Self::Near(_) | Self::Least | Self::Context | Self::Other | Self::Role(_) | Self::Ordinal | Self::Number
        )
    }
}

/// A word or phrase.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Entry {
    /// Folded, without blanks.
    pub(super) letters: String,
    pub(super) senses: Vec<Sense>,
    /// Whether it belongs to a language that writes decimal commas.
    pub(super) commas: bool,
}

impl Entry {
    /// Whether it may be followed by letters that join it to the next word of a compound.
    pub(super) fn takes_link(&self) -> bool {
        self.letters.is_ascii() && self.letters.len() > 4
    }

    /// Whether it is Japanese, which has no blanks between words.
    pub(super) fn is_japanese(&self) -> bool {
        self.letters.chars().next().is_some_and(is_japanese)
    }
}

/// Whether it is a Japanese letter.
pub(super) fn is_japanese(c: char) -> bool {
    matches!(c, '\u{3041}'..='\u{30ff}' | '\u{4e00}'..='\u{9fff}')
}

/// Digits.
pub(super) static NUMBER: LazyLock<Entry> =
    LazyLock::new(|| Entry { letters: String::new(), senses: vec![Sense::Number], commas: false });

/// All words.
pub(super) static VOCABULARY: LazyLock<Vocabulary> = LazyLock::new(Vocabulary::new);

/// The words by their first letter.
#[derive(Debug)]
pub(super) struct Vocabulary(HashMap<char, Vec<Entry>>);

impl Vocabulary {
    fn new() -> Self {
        let mut words: HashMap<char, Vec<Entry>> = HashMap::new();
        for (list, commas) in [(PLAIN, false), (WITH_COMMAS, true)] {
            for (sense, texts) in list {
                for text in texts.split('|') {
                    let letters: String = fold(text).split_whitespace().collect();
                    let Some(first) = letters.chars().next() else { continue };
                    let same_first = words.entry(first).or_default();
                    match same_first.iter_mut().find(|entry| entry.letters == letters) {
                        Some(entry) => {
                            entry.commas &= commas;
                            entry.senses.push(*sense);
                        }
                        None => same_first.push(Entry { letters, senses: vec![*sense], commas }),
                    }
                }
            }
        }
        Self(words)
    }

    /// The words that have the first letter of a text.
    pub(super) fn starting_like(&self, text: &str) -> &[Entry] {
        text.chars().next().and_then(|first| self.0.get(&first)).map_or(&[], Vec::as_slice)
    }

    pub(super) fn all(&self) -> impl Iterator<Item = &Entry> {
        self.0.values().flatten()
    }
}

const OVER_ROLLER: &[Field] = &[Field::Error(DeviationKind::RackOverRoller)];
const OVER_PIN: &[Field] = &[Field::OverPin];
const PITCH: &[Field] = &[Field::Error(DeviationKind::RackPitch), Field::Error(DeviationKind::PinionPitch)];
const RACK_PITCH: &[Field] = &[Field::Error(DeviationKind::RackPitch)];
const PINION_PITCH: &[Field] = &[Field::Error(DeviationKind::PinionPitch)];
const RACK_LEAD: &[Field] = &[Field::Error(DeviationKind::RackLead)];
/// The rack's, unless the pinion is said.
const LEAD: &[Field] = &[Field::Error(DeviationKind::RackLead), Field::Error(DeviationKind::PinionLead)];
const RADIAL: &[Field] = &[Field::Error(DeviationKind::PinionRadial)];
const POSITION: &[Field] = &[Field::Position];
const SPACE: &[Field] = &[Field::Space];
const TOOTH: &[Field] = &[Field::Tooth];
const PART_ID: &[Field] = &[Field::PartId];

/// Words that say nothing of the decimal mark: English, Japanese, symbols, and what German or French share with English.
const PLAIN: &[(Sense, &str)] = &[
    // what is measured
    (
        Sense::Name(OVER_ROLLER),
        "over roller|over rollers|measure over roller|measure over rollers|measurement over roller|\
         measurement over rollers|dimension over roller|dimension over rollers|size over roller|over ball|over balls|\
         measure over ball|measure over balls|measurement over ball|measurement over balls|dimension over ball|\
         dimension over balls|mor|オーバーローラー径|オーバーローラー寸法|オーバーローラー|オーバーボール径|\
         オーバーボール寸法|オーバーボール|オーバー玉径",
    ),
    (Sense::Alone(OVER_ROLLER), "m|roller|rollers"),
    (
        Sense::Name(OVER_PIN),
        "over pin|over pins|measure over pin|measure over pins|measurement over pin|measurement over pins|\
         dimension over pin|dimension over pins|size over pin|diameter over pin|diameter over pins|mop|オーバーピン径|\
         オーバーピン寸法|オーバーピン",
    ),
    (Sense::Alone(OVER_PIN), "pin|pins"),
    (
        Sense::Name(PITCH),
        "pitch|single pitch|individual pitch|adjacent pitch|tooth pitch|tooth to tooth pitch|ピッチ|単一ピッチ|隣接ピッチ",
    ),
    (Sense::Alone(PITCH), "p"),
    (Sense::Error(RACK_PITCH), "dp|delta p"),
    (Sense::Name(RACK_PITCH), "axial pitch|linear pitch|軸方向ピッチ"),
    (Sense::Error(PINION_PITCH), "fp|fpt"),
    (
        Sense::Name(RACK_LEAD),
        "lead angle|helix|helix angle|beta|tooth trace|リード角|ねじれ角|歯すじ|歯すじ方向|歯筋|歯筋方向",
    ),
    (Sense::Name(LEAD), "lead|リード"),
    (Sense::Error(RACK_LEAD), "db|dbeta|delta beta"),
    (Sense::Error(LEAD), "fhbeta|fhb|fhß|helix slope|歯すじ傾斜|歯筋傾斜|歯すじ勾配"),
    (Sense::Name(RADIAL), "radial|radius|radial measure|radial measurement|半径|半径方向"),
    (Sense::Alone(RADIAL), "r"),
    (Sense::Name(POSITION), "position|x position|pin position|roller position|space position|位置|溝位置"),
    (Sense::Alone(POSITION), "pos|x"),
    (
        Sense::Name(SPACE),
        "space|space no|space nr|space number|space #|tooth space|tooth space no|tooth space number|gap|gap no|gap #|溝|溝番号|歯溝|歯溝番号|\
         溝no",
    ),
    (Sense::Name(TOOTH), "tooth|tooth no|tooth nr|tooth number|tooth #|tooth id|歯|歯番号|歯no"),
    (
        Sense::Alone(PART_ID),
        "part|part id|part no|part nr|part nb|part number|part name|part #|id|no|nr|#|serial|serial no|serial nr|\
         serial number|sn|pn|sample|sample no|sample id|workpiece|barcode|piece no|部品番号|部品名|品番|製造番号|\
         シリアル番号|シリアルno|ワーク番号|ワークno|部品|ワーク",
    ),
    // easily taken for one
    (Sense::Near(RADIAL), "runout|run out|radial runout|fr|frr|dr|振れ|歯溝の振れ"),
    (Sense::Near(PITCH), "cumulative pitch|total pitch|base pitch|pitch diameter|fpk|fu|累積ピッチ|ピッチ円直径"),
    (Sense::Near(LEAD), "fbeta|ffbeta|helix form"),
    (Sense::Near(OVER_PIN), "mdk|mdr"),
    (Sense::Near(OVER_ROLLER), "mrk|mr|dm"),
    // of what, and which
    (Sense::Rack, "rack|racks|ラック"),
    (Sense::Pinion, "pinion|pinions|ピニオン"),
    (Sense::Left, "left|lh|lf|l|左|左歯面|左側"),
    (Sense::Right, "right|rh|rf|r|右|右歯面|右側"),
    // what is said of it
    (
        Sense::Deviation,
        "deviation|deviations|dev|error|errors|err|delta|diff|difference|variation|from nominal|actual nominal|誤差|偏差|差",
    ),
    (
        Sense::Measured,
        "measured|measured value|measurement|meas|actual|actual value|act|value|val|result|reading|実測値|測定値|実測|測定|結果",
    ),
    (
        Sense::Nominal,
        "nominal|nominal value|nom|design|design value|theoretical|theo|target|設計値|基準値|公称値|設計|基準|目標値",
    ),
    (
        Sense::Upper,
        "upper|upr|usl|utl|upper limit|up tol|upp tol|hi tol|high tol|up limit|hi limit|high limit|t +|+ t|es|上限|上限値|上限規格|上",
    ),
    (
        Sense::Lower,
        "lower|lwr|lsl|ltl|lower limit|lo tol|low tol|lo limit|low limit|t -|- t|ei|下限|下限値|下限規格|下",
    ),
    (Sense::Plus, "+|plus"),
    (Sense::Minus, "-|minus"),
    (Sense::Tolerance, "tolerance|tol|公差|許容差|規格"),
    (Sense::Limit, "limit|limits|spec limit|許容値"),
    (Sense::Uncertainty, "u|u95|u k2|k2|uncertainty|expanded uncertainty|±|不確かさ|測定不確かさ|拡張不確かさ"),
    (Sense::Greatest, "max|maximum|最大|最大値"),
    (Sense::Least, "min|minimum|最小|最小値"),
    (Sense::Filling, "of|the|at|per|on|and|single|individual|flank|flanks|part|dimension|size|の|寸法|歯面|値"),
    // columns of a table with a row per characteristic
    (
        Sense::Role(Role::Name),
        "id|characteristic|characteristic name|feature|feature name|name|element|parameter|item|description|dimension|\
         label|property|測定項目|項目|項目名|検査項目|要素|名称|特性",
    ),
    (Sense::Role(Role::Unit), "unit|units|単位"),
    (
        Sense::Role(Role::Status),
        "status|outtol|out of tol|out of tolerance|out|exceed|check|verdict|judge|judgement|judgment|ok|nok|pass|fail|\
         pass fail|ok nok|判定|合否|合否判定|状態",
    ),
    (Sense::Ordinal, "no|nr|#"),
    (Sense::Context, CONTEXT),
    (Sense::Context, GEAR_DATA),
];

/// Things that no error is called. Some stand here because a letter more or less makes them one: load, lead.
const CONTEXT: &str = "date|time|timestamp|date time|day|week|month|year|hour|shift|operator|inspector|user|measured by|\
     checked by|machine|device|gauge|gage|cmm|instrument|spindle|station|fixture|pallet|tool|nest|cavity|channel|\
     series|batch|charge|lot|lot no|order|order no|line|plant|customer|supplier|project|drawing|drawing no|revision|rev|version|index|\
     page|pages|program|plan|plan id|type|group|file|file name|temperature|temp|room temperature|humidity|pressure|force|torque|\
     speed|load|leak|leak rate|head|spare|overall|radial force|axial force|patch|hardness|weight|mass|material|comment|comments|remark|remarks|note|\
     notes|info|status|verdict|judge|judgement|judgment|ok|nok|pass|fail|count|quantity|qty|number|lead time|cycle time|\
     scale|日付|日時|時刻|時間|測定日|測定日時|検査日|年月日|測定者|検査者|作業者|担当者|担当|機械|測定機|設備|\
     ロット|ロット番号|ロットno|温度|室温|湿度|備考|コメント|判定|合否|個数|数量|リードタイム|工程|図番|型番|機種";

/// What a gear is, rather than what is wrong with it.
const GEAR_DATA: &str = "module|normal module|transverse module|module mn|mn|モジュール|pressure angle|圧力角|\
     number of teeth|no of teeth|teeth|teeth number|tooth number z|tooth count|歯数|face width|歯幅|roller diameter|pin diameter|ball diameter|\
     diameter of roller|diameter of pin|diameter of ball|measuring pin diameter|measuring roller diameter|\
     measuring ball diameter|ピン径|ローラー径|ボール径|玉径|ピン直径|測定ピン径|tip diameter|outside diameter|\
     root diameter|base diameter|reference diameter|tip radius|root radius|fillet radius|edge radius|歯先円直径|\
     歯先円径|歯底円直径|外径|evaluation length|evaluation range|評価長さ|評価範囲|tolerance class|\
     accuracy class|accuracy grade|quality grade|quality class|精度等級|等級";

/// German and French words.
const WITH_COMMAS: &[(Sense, &str)] = &[
    (
        Sense::Name(OVER_ROLLER),
        "rollenmaß|über rolle|über rollen|über kugel|über kugeln|maß über rolle|maß über rollen|kugelmaß|maß über kugel|\
         maß über kugeln|einkugelmaß|einrollenmaß|sur rouleau|sur rouleaux|mesure sur rouleau|mesure sur rouleaux|\
         cote sur rouleau|cote sur rouleaux|sur bille|sur billes|mesure sur bille|mesure sur billes|cote sur bille|\
         cote sur billes",
    ),
    (Sense::Alone(OVER_ROLLER), "rolle|rollen|rouleau"),
    (
        Sense::Name(OVER_PIN),
        "über stift|über stifte|maß über stift|maß über stifte|stiftmaß|sur pige|sur piges|mesure sur pige|\
         mesure sur piges|cote sur pige|cote sur piges|diamètre sur piges|sur pion",
    ),
    (Sense::Alone(OVER_PIN), "stift|pige"),
    (
        Sense::Name(PITCH),
        "teilung|teilungs|einzelteilung|teilungseinzel|teilungs einzel|zahnteilung|pas|pas individuel|pas simple",
    ),
    (Sense::Name(RACK_PITCH), "axialteilung|pas axial"),
    (
        Sense::Name(RACK_LEAD),
        "schrägung|schrägungswinkel|schrägungswinkels|flankenlinie|flankenlinien|hélice|d hélice|l hélice|\
         angle d hélice|angle de l hélice|angle hélice",
    ),
    (Sense::Name(LEAD), "flankenlinienwinkel|flankenlinien winkel|flankenlinienwinkels"),
    (Sense::Error(LEAD), "d inclinaison d hélice|inclinaison d hélice|inclinaison de l hélice"),
    (Sense::Name(RADIAL), "radiale|radialer|radiales|radialen|radialmaß|rayon|mesure radiale"),
    (
        Sense::Name(POSITION),
        "lage|lückenlage|zahnlage|lückenposition|stiftlage|rollenlage|position du creux|position de la pige",
    ),
    (
        Sense::Name(SPACE),
        "lücke|lücken|lücken nr|lücke nr|lückennummer|zahnlücke|zahnlücken|zahnlücke nr|zahnlücken nr|zahnlückennummer|\
         creux|entredent|n creux|no creux|numéro de creux|numéro du creux|n entredent",
    ),
    (Sense::Name(TOOTH), "zahn|zahn nr|zahnnummer|zahn nummer|dent|n dent|no dent|numéro de dent|numéro de la dent"),
    (
        Sense::Alone(PART_ID),
        "teil|teil nr|teil id|teile nr|teilenummer|teile nummer|teilnummer|seriennummer|serien nr|werkstück|werkstück nr|\
         werkstücknummer|bauteil|bauteil nr|probe|proben nr|lfd nr|laufende nummer|teilename|teile id|pièce|n pièce|no pièce|\
         numéro de pièce|numéro pièce|numéro de la pièce|nom de pièce|n de pièce|n série|n de série|numéro de série|échantillon",
    ),
    (Sense::Near(RADIAL), "rundlauf|rundlaufs|faux rond|faux rond radial|battement"),
    (
        Sense::Near(PITCH),
        "gesamtteilung|gesamtteilungs|summenteilung|summenteilungs|teilungssummen|teilungsgesamt|teilungssprung|\
         eingriffsteilung|pas cumulé|cumulé de pas|pas de base|steigung",
    ),
    (
        Sense::Near(LEAD),
        "zahnrichtung|zahnrichtungs|flankenliniengesamt|flankenlinienform|flankenlinien form|flankenlinien gesamt",
    ),
    (Sense::Near(OVER_PIN), "zweikugelmaß|zweirollenmaß|zweistiftmaß"),
    (
        Sense::Rack,
        "zahnstange|zahnstangen|zst|zs|zahnst|zahnstg|zstg|crém|crémaillère|de crémaillère|de la crémaillère",
    ),
    (Sense::Pinion, "ritzel|ritzels|pignon|de pignon|du pignon"),
    (Sense::Left, "links|linke|linken|linker|li|gauche|g"),
    (Sense::Right, "rechts|rechte|rechten|rechter|re|droite|droit"),
    (
        Sense::Deviation,
        "abweichung|abweichungen|abw|fehler|messfehler|messabweichung|differenz|diff|ist soll|soll ist abweichung|ist soll abweichung|vom soll|vom sollwert|vom sollmaß|\
         vom nennmaß|von nennmaß|zum soll|zum nennmaß|zu soll|écart|écarts|erreur|par rapport au nominal|déviation",
    ),
    (
        Sense::Measured,
        "ist|istwert|istmaß|ist maß|istm|messwert|gemessen|gemessene|wert|messung|ergebnis|mesuré|mesurée|mesure|valeur|\
         valeur mesurée|réel|relevé|résultat",
    ),
    (
        Sense::Nominal,
        "soll|sollwert|sollmaß|nenn|nennmaß|nennwert|sollm|nennm|vorgabe|nominale|valeur nominale|cote nominale|théorique|théo|cible",
    ),
    (
        Sense::Upper,
        "obere|oberer|oberes|oben|ob|ot|otg|og|ogw|osg|ob tol|o tol|höchstmaß|größtmaß|obergrenze|obere grenze|\
         oberer grenzwert|supérieur|supérieure|sup|ts|tol sup",
    ),
    (
        Sense::Lower,
        "untere|unterer|unteres|unt|ut|utg|ug|ugw|usg|unt tol|u tol|mindestmaß|kleinstmaß|untergrenze|untere grenze|\
         unterer grenzwert|inférieur|inférieure|inf|ti|tol inf",
    ),
    (Sense::Tolerance, "toleranz|toleranzgrenze|abmaß|grenzabmaß|tolérance|écart limite|iso tol"),
    (Sense::Limit, "grenze|grenzwert|grenzmaß|spezifikationsgrenze|limite"),
    (
        Sense::Uncertainty,
        "unsicherheit|messunsicherheit|erweiterte messunsicherheit|erweiterte unsicherheit|incertitude|\
         incertitude de mesure|incertitude élargie",
    ),
    (Sense::Greatest, "maximal|maximale|größte|größter"),
    (Sense::Least, "minimal|minimale|kleinste|kleinster"),
    (
        Sense::Filling,
        "der|des|die|das|an|am|im|bei|von|vom|für|pro|je|einzel|flanke|individuel|teil|maß|winkel|und|de|du|la|le|les|l|d|sur|flanc|pièce|cote",
    ),
    (
        Sense::Role(Role::Name),
        "merkmal|merkmalsname|merkmalsbezeichnung|bezeichnung|prüfmerkmal|größe|benennung|eigenschaft|messgröße|\
         caractéristique|désignation|nom de la cote|nom de cote|élément|paramètre|libellé",
    ),
    (Sense::Role(Role::Unit), "einheit|einheiten|einh|unité|unités"),
    (
        Sense::Role(Role::Status),
        "bewertung|außer tol|außer toleranz|überschreitung|übersch|i o|n i o|urteil|entscheid|hors tol|hors tolérance|\
         état|conformité|statut|verdict",
    ),
    (
        Sense::Context,
        "datum|zeit|uhrzeit|messzeit|messdatum|prüfdatum|zeitstempel|tag|woche|monat|jahr|schicht|prüfer|bediener|werker|\
         mitarbeiter|benutzer|maschine|maschinen nr|messmaschine|messgerät|prüfmittel|gerät|kmg|spindel|vorrichtung|\
         palette|werkzeug|kavität|serie|los|auftrag|auftrags nr|auftragsnummer|linie|werk|kunde|lieferant|projekt|\
         zeichnung|zeichnungs nr|zeichnungsnummer|programm|prüfplan|typ|gruppe|datei|temperatur|raumtemperatur|\
         bauteiltemperatur|feuchte|luftfeuchte|druck|kraft|radialkraft|axialkraft|moment|drehmoment|drehzahl|härte|gewicht|masse|werkstoff|\
         material|bemerkung|bemerkungen|kommentar|anmerkung|hinweis|bewertung|urteil|i o|n i o|anzahl|menge|stück|\
         stückzahl|zahl|abteilung|verteilung|heizung|leitung|lager|lagerort|\
         heure|jour|semaine|opérateur|contrôleur|équipe|appareil|poste|numéro de lot|n lot|n de lot|commande|\
         ligne|usine|client|plan|température|humidité|pression|couple|effort|dureté|poids|matière|remarque|commentaire|\
         observation|état|nombre|quantité|statut",
    ),
    (Sense::Other, "länge|längen|zahndicke|zahndicken|mitteilung|beurteilung|zuteilung|einteilung|unterteilung"),
    (
        Sense::Context,
        "modul|normalmodul|stirnmodul|eingriffswinkel|zähnezahl|zähnezahlen|zahnbreite|verzahnungsbreite|\
         rollendurchmesser|messrollendurchmesser|kugeldurchmesser|messkugeldurchmesser|stiftdurchmesser|\
         messstiftdurchmesser|durchmesser rolle|durchmesser kugel|kopfkreisdurchmesser|kopfkreis|fußkreisdurchmesser|\
         fußkreis|grundkreisdurchmesser|grundkreis|teilkreisdurchmesser|teilkreis|kopfradius|fußradius|\
         auswertelänge|auswertebereich|prüfbereich|toleranzklasse|verzahnungsqualität|qualität|\
         angle de pression|nombre de dents|largeur de denture|largeur de dent|diamètre de pige|diamètre de la pige|\
         diamètre pige|diamètre de rouleau|diamètre du rouleau|diamètre de bille|diamètre de la bille|diamètre de tête|\
         diamètre de pied|longueur d évaluation|classe de tolérance|classe de précision|classe de qualité",
    ),
];
