//! A workbook is closed in its XML too: whatever attribute, element or text of a part is changed, what comes out changes, or the run
//! ends. What is left out by decision stands in [`IGNORED`], by its element.

use std::io::{Cursor, Write as _};
use std::ops::Range;

use super::closure::{Kind, Random, contract, observed};
use super::*;

const TYPE: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";

/// A small workbook: each part with its XML.
const PARTS: [(&str, &str); 13] = [
    (
        "_rels/.rels",
        "<Relationships><Relationship Id='r0' Type='{}/officeDocument' Target='xl/workbook.xml'/></Relationships>",
    ),
    (
        "xl/workbook.xml",
        "<workbook><workbookPr/><bookViews><workbookView activeTab='0'/></bookViews><sheets>\
         <sheet name='Lot' sheetId='1' r:id='r1'/><sheet name='Notes' sheetId='2' state='hidden' r:id='r2'/>\
         <sheet name='Bild' sheetId='3' r:id='r3'/></sheets>\
         <definedNames><definedName name='Print_Area' localSheetId='0' comment='druckt'>Lot!$A$1:$E$6</definedName></definedNames>\
         <calcPr calcId='1' fullCalcOnLoad='1'/></workbook>",
    ),
    (
        "xl/_rels/workbook.xml.rels",
        "<Relationships><Relationship Id='r1' Type='{}/worksheet' Target='worksheets/sheet1.xml'/>\
         <Relationship Id='r2' Type='{}/worksheet' Target='worksheets/sheet2.xml'/>\
         <Relationship Id='r3' Type='{}/chartsheet' Target='chartsheets/sheet1.xml'/></Relationships>",
    ),
    (
        "xl/sharedStrings.xml",
        "<sst count='9' uniqueCount='9'><si><t>Prüfprotokoll 7</t></si><si><t>Teil</t></si><si><t>Rollenmaß [mm]</t></si>\
         <si><t>Temp [°C]</t></si><si><t>CHR_017</t></si><si><t>Temp 2</t></si><si><t>P1</t></si>\
         <si><r><rPr><b/><sz val='9'/><vertAlign val='baseline'/></rPr><t>25.0</t></r><r><t>08</t></r></si>\
         <si><t>P3</t><rPh sb='0' eb='1'><t>ピー</t></rPh><phoneticPr fontId='0'/></si><si><t>kein Wert</t></si></sst>",
    ),
    (
        "xl/styles.xml",
        "<styleSheet><numFmts count='2'><numFmt numFmtId='164' formatCode='~0.0'/><numFmt numFmtId='165' formatCode='dd.mm.yyyy'/>\
         </numFmts><fonts count='2'><font><sz val='11'/><color rgb='FF000000'/><name val='Calibri'/></font>\
         <font><vertAlign val='superscript'/><strike/></font></fonts>\
         <fills count='1'><fill><patternFill patternType='none'/></fill></fills><borders count='1'><border><left/></border></borders>\
         <cellXfs count='3'><xf fillId='0' borderId='0'/>\
         <xf numFmtId='164' applyNumberFormat='1'><alignment horizontal='left'/></xf><xf numFmtId='165'/><xf fontId='1'/></cellXfs><dxfs count='2'><dxf><font><strike/><color rgb='FFFF0000'/></font></dxf>\
         <dxf><numFmt numFmtId='166' formatCode='0%'/></dxf></dxfs></styleSheet>",
    ),
    (
        "xl/worksheets/sheet1.xml",
        "<worksheet><sheetPr><tabColor rgb='FF00FF00'/></sheetPr><dimension ref='A1:E6'/>\
         <sheetViews><sheetView showGridLines='0' workbookViewId='0'><selection activeCell='B2' sqref='B2'/>\
         </sheetView></sheetViews><sheetFormatPr/><cols><col min='2' max='2' hidden='1'/><col min='4' max='4' width='0'/>\
         </cols><sheetData><row r='1' spans='1:5'><c r='A1' t='s'><v>0</v></c></row>\
         <row r='2'><c r='A2' t='s'><v>1</v></c><c r='B2' t='s'><v>2</v></c><c r='C2' t='s'><v>3</v></c><c r='D2' t='s'><v>4</v></c>\
         <c r='E2' t='s'><v>5</v></c></row>\
         <row r='3'><c r='A3' t='s'><v>6</v></c><c r='B3'><v>25.011</v></c><c r='C3' s='1'><v>20.5</v></c>\
         <c r='D3'><v>3.1</v></c><c r='E3' s='2'><v>46000</v></c></row>\
         <row r='4'><c r='A4' t='inlineStr'><is><r><rPr><i/></rPr><t>P</t></r><r><t>2</t></r></is></c>\
         <c r='B4'><f>B3-0.007</f><v>25.004</v></c><c r='D4'><v>-2.2</v></c><c r='E4' s='3' t='b'><v>1</v></c></row>\
         <row r='5'><c r='A5' t='s'><v>8</v></c><c r='B5' t='s'><v>7</v></c><c r='C5' t='str'><f>A1</f><v>2e1</v></c>\
         <c r='D5'><v>0</v></c></row></sheetData><sheetProtection sheet='1'/>\
         <mergeCells count='1'><mergeCell ref='C3:C4'/></mergeCells>\
         <conditionalFormatting sqref='B3:B5'><cfRule type='cellIs' dxfId='0' priority='1' operator='lessThan'><formula>0</formula></cfRule>\
         <cfRule priority='2'><dataBar showValue='0'><cfvo type='min'/></dataBar></cfRule><cfRule dxfId='1' priority='3'/></conditionalFormatting>\
         <dataValidations count='1'><dataValidation type='decimal' promptTitle='Rolle' prompt='in mm' errorTitle='Fehler' error='zu groß' \
         sqref='B3:B5'><formula1>24</formula1></dataValidation></dataValidations>\
         <hyperlinks><hyperlink ref='A3' location='Notes!A1' tooltip='siehe Blatt' display='P1'/></hyperlinks>\
         <pageMargins left='0.7'/><pageSetup orientation='portrait'/>\
         <headerFooter differentFirst='1'><oddHeader>&amp;CLos 7</oddHeader><firstFooter>Seite &amp;P</firstFooter></headerFooter>\
         <drawing r:id='r1'/><legacyDrawing r:id='r2'/><tableParts count='1'><tablePart r:id='r3'/></tableParts></worksheet>",
    ),
    (
        "xl/worksheets/sheet2.xml",
        "<worksheet><sheetData><row r='1'><c r='A1' t='s'><v>9</v></c></row></sheetData></worksheet>",
    ),
    (
        "xl/chartsheets/sheet1.xml",
        "<chartsheet><sheetViews><sheetView workbookViewId='0'/></sheetViews><drawing r:id='r1'/></chartsheet>",
    ),
    (
        "xl/comments1.xml",
        "<comments><authors><author>Huber</author></authors><commentList><comment ref='B3' authorId='0'><text><r><rPr><b/></rPr>\
         <t>Huber:</t></r><r><t>&#10;neu</t></r></text></comment><comment ref='B4' authorId='0'><text><t>Comment: Zoll, nicht mm</t></text>\
         </comment></commentList></comments>",
    ),
    (
        "xl/threadedComments/threadedComment1.xml",
        "<ThreadedComments><threadedComment ref='B4' dT='2026-01-01' personId='{0}' id='{1}'><text>Zoll, nicht mm</text></threadedComment>\
         <threadedComment ref='B4' personId='{0}' id='{2}' parentId='{1}'><text>doch mm</text></threadedComment></ThreadedComments>",
    ),
    (
        "xl/drawings/vmlDrawing1.vml",
        "<xml><v:shape id='s1' type='#t202'><v:fill color2='#ffffe1'/><v:textbox style='a'><div style='b'><font>nur</font> Muster</div>\
         </v:textbox><x:ClientData ObjectType='Note'><x:Row>2</x:Row><x:Column>1</x:Column></x:ClientData></v:shape></xml>",
    ),
    (
        "xl/drawings/drawing1.xml",
        "<xdr:wsDr><xdr:twoCellAnchor><xdr:from><xdr:col>1</xdr:col></xdr:from><xdr:sp><xdr:nvSpPr><xdr:cNvPr id='2' name='Box' descr='Bild'/>\
         </xdr:nvSpPr><xdr:spPr><a:prstGeom prst='rect'/></xdr:spPr><xdr:txBody><a:p><a:r><a:rPr lang='de'/><a:t>ungültig</a:t></a:r></a:p>\
         <a:p><a:fld id='f' type='slidenum'><a:t>ab 3</a:t></a:fld></a:p></xdr:txBody></xdr:sp><xdr:graphicFrame><c:chart r:id='r1'/></xdr:graphicFrame></xdr:twoCellAnchor></xdr:wsDr>",
    ),
    (
        "xl/tables/table1.xml",
        "<table id='1' name='T' displayName='T' ref='A2:E5' comment='Werte in mm'><autoFilter ref='A2:E5'/><tableColumns count='1'>\
         <tableColumn id='1' name='Teil'/></tableColumns><tableStyleInfo name='S'/></table>",
    ),
];

/// What changes nothing by decision: the beginning of a part's name, elements, and what of them: attributes, `text`, `element` (all of it,
/// taken away) or `again` (all of it, twice). `*` is any.
const IGNORED: &[(&str, &[&str], &[&str])] = &[
    // what lists say of themselves, and which numbers and names parts have among each other
    ("", &["*"], &["count", "uniqueCount", "spans", "priority"]),
    ("_rels/", &["xml", "Relationship"], &["encoding", "Id"]),
    ("xl/workbook.xml", &["sheet"], &["sheetId"]),
    ("xl/worksheets/", &["dimension", "drawing", "legacyDrawing", "tableParts", "tablePart"], &["*"]),
    ("xl/drawings/", &["xdr:graphicFrame", "c:chart", "xdr:nvSpPr", "xdr:cNvPr", "v:shape", "a:fld"], &["*"]),
    ("xl/tables/", &["table"], &["id", "ref"]),
    // defined names, print ranges, names of tables; when formulas are computed
    ("xl/workbook.xml", &["definedNames", "definedName", "calcPr"], &["*"]),
    ("xl/worksheets/", &["f"], &["*"]),
    ("xl/tables/", &["table"], &["name", "displayName"]),
    ("xl/tables/", &["autoFilter", "tableColumns", "tableColumn", "tableStyleInfo"], &["*"]),
    // what a window shows first; whether other sheets are hidden
    ("xl/workbook.xml", &["bookViews", "workbookView", "workbookPr"], &["element", "activeTab"]),
    ("xl/workbook.xml", &["sheet"], &["state"]),
    (
        "xl/worksheets/",
        &["sheetViews", "sheetView", "selection"],
        &["element", "showGridLines", "workbookViewId", "activeCell", "sqref"],
    ),
    // colours, sizes that do not hide, alignment, fonts
    (
        "xl/styles.xml",
        &["sz", "color", "name", "vertAlign", "fills", "fill", "patternFill", "borders", "border", "left", "alignment"],
        &["*"],
    ),
    ("xl/styles.xml", &["xf"], &["fillId", "borderId", "applyNumberFormat"]),
    ("xl/", &["rPr", "b", "i"], &["element"]),
    ("xl/worksheets/", &["sheetPr", "tabColor", "pageMargins", "pageSetup", "sheetProtection"], &["*"]),
    ("xl/worksheets/", &["sheetFormatPr"], &["element"]),
    // the number of a conditional format, and bars
    ("xl/styles.xml", &["numFmt"], &["numFmtId"]),
    ("xl/worksheets/", &["dataBar", "cfvo"], &["element", "type"]),
    // what may be typed into a cell, where a link leads to, on which pages a header stands
    ("xl/worksheets/", &["formula1"], &["*"]),
    ("xl/worksheets/", &["dataValidation"], &["type"]),
    ("xl/worksheets/", &["hyperlink", "headerFooter"], &["location", "display", "differentFirst"]),
    // who wrote a comment, when, and in answer to which
    ("xl/comments1.xml", &["authors", "author"], &["*"]),
    ("xl/comments1.xml", &["comment"], &["authorId"]),
    ("xl/threadedComments/", &["threadedComment"], &["dT", "personId", "id", "parentId"]),
    // where a box stands and how it is drawn; reading aids
    ("xl/drawings/", &["xdr:from", "xdr:col", "xdr:spPr", "a:prstGeom", "a:rPr"], &["*"]),
    ("xl/drawings/", &["v:fill", "x:ClientData", "x:Row", "x:Column"], &["*"]),
    ("xl/drawings/", &["v:textbox", "div"], &["style"]),
    ("xl/sharedStrings.xml", &["rPh", "phoneticPr"], &["*"]),
];

/// A part of XML, as it can be changed.
struct Element {
    name: String,
    /// The tag that opens it.
    tag: Range<usize>,
    /// All of it.
    whole: Range<usize>,
    /// Its own attributes: name and value.
    attributes: Vec<(Range<usize>, Range<usize>)>,
    /// The texts that stand in it, not in an element within.
    texts: Vec<Range<usize>>,
}

fn elements(xml: &str) -> Vec<Element> {
    let (mut all, mut open, mut at) = (Vec::<Element>::new(), Vec::<usize>::new(), 0);
    while let Some(start) = xml[at..].find('<').map(|found| at + found) {
        let end = start + xml[start..].find('>').unwrap() + 1;
        if let Some(parent) = open.last().filter(|_| !xml[at..start].trim().is_empty()) {
            all[*parent].texts.push(at..start);
        }
        if xml[start..].starts_with("</") {
            let closed = open.pop().unwrap();
            all[closed].whole.end = end;
        } else {
            let name_end = start + xml[start..].find([' ', '/', '>']).unwrap();
            let mut attributes = Vec::new();
            let mut from = name_end;
            while let Some(quote) = xml[from..end].find("='").map(|found| from + found) {
                let name = from + xml[from..quote].rfind(' ').unwrap() + 1..quote;
                let value = quote + 2..quote + 2 + xml[quote + 2..].find('\'').unwrap();
                from = value.end;
                attributes.push((name, value));
            }
            let name = xml[start + 1..name_end].to_owned();
            all.push(Element { name, tag: start..end, whole: start..end, attributes, texts: Vec::new() });
            if !xml[..end].ends_with("/>") {
                open.push(all.len() - 1);
            }
        }
        at = end;
    }
    all
}

/// What else an attribute may be, where it means something else.
fn values(key: &str) -> &'static [&'static str] {
    match key {
        "hidden" | "ht" | "width" | "defaultRowHeight" => &["0"],
        "numFmtId" => &["9", "165"],
        "formatCode" => &["0.00%", "0\" in\""],
        "fontId" => &["0", "1", "7"],
        "s" => &["3", "999", "x"],
        "t" => &["s", "str", "b", "e"],
        "val" => &["1", "superscript", "subscript"],
        "min" => &["3"],
        "max" => &["1", "5"],
        "state" => &["visible"],
        "r" => &["1", "9", "B9"],
        "ref" | "sqref" => &["B9", "A2:A3", "in Zoll"],
        "dxfId" => &["1", "2"],
        _ => &["0", "7", "in Zoll"],
    }
}

/// Attributes that change how something is shown or read.
const MORE: [(&str, &str); 13] = [
    ("workbookPr", "date1904='1'"),
    ("sheet", "state='hidden'"),
    ("sheetView", "showZeros='0'"),
    ("sheetView", "showFormulas='1'"),
    ("sheetFormatPr", "zeroHeight='1'"),
    ("row", "hidden='true'"),
    ("row", "ht='0'"),
    ("c", "s='3'"),
    ("c", "t='s'"),
    ("sheetFormatPr", "defaultRowHeight='0'"),
    ("hyperlink", "tooltip='in > mm'"),
    ("dataValidation", "prompt='in > mm'"),
    ("table", "comment='in > mm'"),
];

/// Elements of which two say something else than one.
const AGAIN: [&str; 13] = [
    "sheet",
    "si",
    "t",
    "row",
    "c",
    "v",
    "is",
    "dataValidation",
    "oddHeader",
    "comment",
    "threadedComment",
    "xdr:sp",
    "a:t",
];

/// Each change of a part's XML: the element, what of it, and the XML after it.
fn changes(xml: &str) -> Vec<(String, String, String)> {
    let with = |range: &Range<usize>, text: &str| format!("{}{text}{}", &xml[..range.start], &xml[range.end..]);
    let mut all =
        vec![("xml".to_owned(), "encoding".to_owned(), format!("<?xml version='1.0' encoding='latin1'?>{xml}"))];
    for element in elements(xml) {
        let Element { name, tag, whole, attributes, texts } = &element;
        let mut add = |what: &str, xml: String| all.push((name.clone(), what.to_owned(), xml));
        for (key, value) in attributes {
            let what = &xml[key.clone()];
            for text in values(what) {
                add(what, with(value, text));
            }
            // where a cell without it stands is counted
            if what != "r" {
                add(what, with(&(key.start..value.end + 1), ""));
            }
        }
        for (_, attribute) in MORE.iter().filter(|(element, _)| element == name) {
            let what = attribute.split_once('=').unwrap().0;
            if !attributes.iter().any(|(key, _)| &xml[key.clone()] == what) {
                let at = tag.start + 1 + name.len();
                add(what, with(&(at..at), &format!(" {attribute}")));
            }
        }
        for text in texts {
            for other in ["", "7", "in Zoll"] {
                add("text", with(text, other));
            }
            for more in ["1", "<!-- 1 -->", "<![CDATA[1]]>"] {
                add("text", with(&(text.end..text.end), more));
            }
            add("text", with(text, &format!("<![CDATA[{}]]>", &xml[text.clone()])));
        }
        if whole.start > 0 {
            add("element", with(whole, ""));
        }
        if AGAIN.contains(&name.as_str()) {
            add("again", with(&(whole.end..whole.end), &xml[whole.clone()]));
        }
    }
    all
}

/// The workbook with one part changed.
fn book(part: &str, xml: &str) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, own) in PARTS {
        archive.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        let xml = if name == part { xml } else { own };
        archive.write_all(xml.replace("{}", TYPE).as_bytes()).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

fn is_ignored(part: &str, element: &str, what: &str) -> bool {
    let has = |list: &[&str], one: &str| list.contains(&"*") || list.contains(&one);
    IGNORED.iter().any(|(parts, elements, whats)| part.starts_with(parts) && has(elements, element) && has(whats, what))
}

#[test]
fn no_change_of_a_workbooks_xml_goes_unnoticed() {
    let long = std::env::var("RACKMESH_LONG_TESTS").is_ok_and(|value| value == "1");
    let want = contract("CHR_017");
    let comments = vec![Pattern::of_heading("*")];
    let layout = Layout { sheet: Some("Lot".to_owned()), comments, ..(*want.layout).clone() };
    let want = Want { layout: layout.into(), ..want };
    let seen = |bytes: Vec<u8>| observed(Kind::Workbook, bytes, &want);
    let before = seen(book("", "")).unwrap_or_else(|problem| panic!("{problem}"));
    let (mut random, mut tried, mut unnoticed) = (Random(0x9e37_79b9_7f4a_7c15), 0, Vec::new());
    for (part, own) in PARTS {
        for (element, what, xml) in changes(own) {
            let is_tried = long || random.below(4) == 0;
            if is_tried && xml != own && !is_ignored(part, &element, &what) {
                tried += 1;
                if seen(book(part, &xml)).is_ok_and(|after| after == before) {
                    let from = own.bytes().zip(xml.bytes()).take_while(|(one, other)| one == other).count();
                    let near: String = xml.chars().skip(from.saturating_sub(30)).take(90).collect();
                    unnoticed.push(format!("{part} {element} {what}: … {near} …"));
                }
            }
        }
    }
    println!("{tried} changes, {} unnoticed", unnoticed.len());
    assert!(unnoticed.is_empty(), "{} of {tried} changes go unnoticed:\n{}", unnoticed.len(), unnoticed.join("\n"));
}

/// What a workbook says beside the cells of its sheet: comments of both kinds, boxes of both kinds, remarks on tables, prompts and
/// the like are listed, each with its place; other sheets and charts are left out by name.
#[test]
fn what_stands_beside_the_cells_is_listed_or_left_out_by_name() {
    let want = contract("CHR_017");
    let of = |comments: Vec<Pattern>| {
        let layout = Layout { sheet: Some("Lot".to_owned()), comments, ..(*want.layout).clone() };
        read_file("lot.xlsx", &book("", ""), &Want { layout: layout.into(), ..want.clone() })
    };
    let refused = of(Vec::new()).unwrap_err();
    for said in [
        "comment B3: Huber: neu",
        "comment B4: Comment: Zoll, nicht mm",
        "comment B4: Zoll, nicht mm",
        "comment B4: doch mm",
        "text box: nur Muster",
        "text box: ungültig",
        "table: Werte in mm",
        "prompt of B3:B5: Rolle in mm Fehler zu groß",
        "prompt of A3: siehe Blatt",
        "conditional format B3:B5: strikes through: cellIs lessThan 0",
        "page header: Los 7",
    ] {
        assert!(refused.contains(said), "{said}: {refused}");
    }
    let read = of(vec![Pattern::of_heading("*")]).unwrap();
    let others = read.reading.left_out.iter().find(|rule| rule.rule == "other sheets").unwrap().to_string();
    assert!(others.contains("2 texts (Notes, Bild)"), "{others}");
}
