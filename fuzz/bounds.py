#!/usr/bin/env python3
"""Inputs that are small and ask for much: each has to end within some seconds and MiB, and within a second of a signal.

    python3 fuzz/bounds.py target/release/rackmesh [--seconds 2] [--mib 64]

Specs may take 128 MiB.

The files are made here, in a folder of their own that is removed at the end.
"""
import argparse, gzip, io, os, signal, struct, subprocess, sys, tempfile, time, zipfile

SPEC = """[pair]
normal_module = 2
normal_pressure_angle = 20
[errors]
rack_over_roller = { nominal = 25 }
[table]
ignore = ["note"]
"""


PAIR = """[pair]
normal_module = 2
normal_pressure_angle = 20
[rack]
face_width = 20
addendum = 2
[pinion]
teeth = 17
tip_diameter = 38
face_width = 20
"""


def varint(number):
    out = b""
    while number > 0x7F:
        out, number = out + bytes([number & 0x7F | 0x80]), number >> 7
    return out + bytes([number])


class Record:
    """A record of Thrift's compact form."""

    def __init__(self):
        self.out, self.last = b"", 0

    def field(self, number, kind, data):
        self.out += bytes([(number - self.last) << 4 | kind]) + data
        self.last = number
        return self

    def i32(self, number, value):
        return self.field(number, 5, varint(value << 1))

    def i64(self, number, value):
        return self.field(number, 6, varint(value << 1))

    def text(self, number, text):
        return self.field(number, 8, varint(len(text)) + text)

    def record(self, number, record):
        return self.field(number, 12, record.end())

    def records(self, number, records):
        count = len(records)
        length = bytes([count << 4 | 12]) if count < 15 else bytes([0xFC]) + varint(count)
        return self.field(number, 9, length + b"".join(record.end() for record in records))

    def end(self):
        return self.out + b"\0"


def page(kind, raw, header):
    packed = gzip.compress(raw, mtime=0)
    head = Record().i32(1, kind).i32(2, len(raw)).i32(3, len(packed))
    return head.record(7 if kind == 2 else 5, header).end() + packed, len(head.end())


def parquet(rows, size, texts=1, more=0):
    """`part_id` and `rack_over_roller_mm`, `note`, whose cells are `size` bytes each, in a dictionary, and `more` columns of numbers."""
    out, chunks = io.BytesIO(), []
    out.write(b"PAR1")

    def column(name, physical, pages, unpacked):
        start = out.tell()
        for data in pages:
            out.write(data)
        chunks.append((name, physical, start, len(pages[0]) if len(pages) > 1 else None, out.tell() - start, unpacked))

    def plain(raw):
        return page(0, raw, Record().i32(1, rows).i32(2, 0).i32(3, 3).i32(4, 3))[0]

    names = b"".join(struct.pack("<I", len(n)) + n for n in (b"P%d" % i for i in range(rows)))
    column(b"part_id", 6, [plain(names)], len(names))
    column(b"rack_over_roller_mm", 5, [plain(struct.pack("<d", 25.01) * rows)], 8 * rows)
    dictionary = b"".join(struct.pack("<I", size) + bytes([97 + i]) * size for i in range(texts))
    first = page(2, dictionary, Record().i32(1, texts).i32(2, 2))[0]
    # one run of the first text: its width in bits, and how often
    data = page(0, b"\x01" + varint(rows << 1) + b"\0", Record().i32(1, rows).i32(2, 8).i32(3, 3).i32(4, 3))[0]
    column(b"note", 6, [first, data], len(dictionary))
    for number in range(more):
        column(b"c%d" % number, 5, [plain(struct.pack("<d", 1.5) * rows)], 8 * rows)
    schema = [Record().text(4, b"lot").i32(5, 3 + more)]
    schema += [
        Record().i32(1, physical).i32(3, 0).text(4, name).i32(6, 0) if physical == 6 else Record().i32(1, physical).i32(3, 0).text(4, name)
        for name, physical, *_ in chunks
    ]
    columns = []
    for name, physical, start, behind, packed, unpacked in chunks:
        meta = Record().i32(1, physical).field(2, 9, bytes([0x25]) + varint(0) + varint(16)).field(3, 9, bytes([0x18]) + varint(len(name)) + name)
        meta = meta.i32(4, 2).i64(5, rows).i64(6, unpacked).i64(7, packed).i64(9, start + (behind or 0))
        columns.append(Record().i64(2, start).record(3, meta.i64(11, start) if behind else meta))
    group = Record().records(1, columns).i64(2, sum(c[5] for c in chunks)).i64(3, rows)
    footer = Record().i32(1, 1).records(2, schema).i64(3, rows).records(4, [group]).end()
    return out.getvalue() + footer + struct.pack("<I", len(footer)) + b"PAR1"


def workbook(rows, shared=(), sheets=1):
    """A workbook of these rows, each a list of places and texts; numbers that begin with # are of shared texts. All sheets are one part."""
    main = 'xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"'

    def cell(place, text):
        if text.startswith("#"):
            return f'<c r="{place}" t="s"><v>{text[1:]}</v></c>'
        return f'<c r="{place}" t="inlineStr"><is><t>{text}</t></is></c>'

    lines = "".join(f'<row r="{n}">' + "".join(cell(p + str(n), t) for p, t in row) + "</row>" for n, row in enumerate(rows, 1))
    strings = "".join(f"<si><t>{text}</t></si>" for text in shared)
    names = "".join(f'<sheet name="A{n}" sheetId="{n + 1}" r:id="a"/>' for n in range(sheets))
    relation = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
    files = {
        "[Content_Types].xml": '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"/>',
        "_rels/.rels": f'<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="a" Type="{relation}/officeDocument" Target="xl/workbook.xml"/></Relationships>',
        "xl/workbook.xml": f'<workbook {main} xmlns:r="{relation}"><sheets>{names}</sheets></workbook>',
        "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="a" Type="{relation}/worksheet" Target="worksheets/sheet1.xml"/><Relationship Id="b" Type="{relation}/sharedStrings" Target="sharedStrings.xml"/></Relationships>',
        "xl/worksheets/sheet1.xml": f"<worksheet {main}><sheetData>{lines}</sheetData></worksheet>",
        "xl/sharedStrings.xml": f"<sst {main}>{strings}</sst>",
    }
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in files.items():
            archive.writestr(name, text)
    return out.getvalue()


def inputs():
    head = "part_id;rack_over_roller [mm]\n"
    row = "P1;25,01\n"
    yield "a text of 64 MiB in a dictionary", "a.parquet", parquet(400, 64 << 20)
    yield "texts of 100 kB in a dictionary", "b.parquet", parquet(200_000, 100_000, 100)
    yield "a shared text of 1 MB", "c.xlsx", workbook([[("A", "part_id"), ("B", "#0")]], ["x" * 1_000_000])
    yield "cells in A and XFD", "d.xlsx", workbook([[("A", "part_id"), ("XFD", "note")]] + [[("A", "P"), ("XFD", "1")]] * 400)
    parts = 20_000
    across = "Teil;" + ";".join(f"P{n}" for n in range(parts)) + "\nrack_over_roller [mm];" + ";".join(["25,01"] * parts) + "\n"
    yield "20,000 parts in columns", "e.csv", across.encode()
    yield "10,000 unknown columns", "f.csv", (head.strip() + "".join(f";c{n}" for n in range(10_000)) + "\n" + row.strip() + ";1" * 10_000 + "\n").encode()
    yield "20,000 lines above a table", "g.csv", ("".join(f"line {n} of words\n" for n in range(20_000)) + head + row).encode()
    yield "64 MB of one line", "h.csv", (head + "x" * (64 << 20)).encode()
    yield "64 MB of words", "i.csv", b"some words and no table\n" * (64 << 20 >> 5)
    yield "50,000 sheets", "s.xlsx", workbook([[("A", "part_id"), ("B", "rack_over_roller [mm]")], [("A", "P1"), ("B", "25.01")]], (), 50_000)
    yield "20,000 columns in Parquet", "t.parquet", parquet(1, 8, 1, 20_000)
    yield "2,000 columns and 400 rows in Parquet", "u.parquet", parquet(400, 8, 1, 2000)
    lot = b"K0100 1\nK2002/1 rack_over_roller\nK2142/1 mm\n"
    yield "two million remarks in Q-DAS", "v.dfq", lot + b"".join(b"K2900/1 remark %d\n" % n for n in range(2_000_000)) + b"25.01\n"
    yield "nine million values in Q-DAS", "w.dfq", lot + b"25.01\n" * 9_000_000
    names = b"".join(b"K2002/%d c%d\n" % (n, n) for n in range(2, 1000))
    rows = (b"25.01\x0f" * 998 + b"25.01\n") * 1000
    yield "999 characteristics in Q-DAS", "x.dfq", lot.replace(b"K0100 1", b"K0100 999") + names + rows
    yield "a remark of 8 MB in Q-DAS", "j.dfq", b"K0100 1\nK2002/1 rack_pitch\nK1900/1 " + b"x" * (8 << 20) + b"\n1\n"
    yield "20,000 remarks in Q-DAS", "k.dfq", b"K0100 1\nK2002/1 rack_pitch\n" + b"K1900/1 x\n" * 20_000 + b"1\n"
    rows = "".join(f"P{n % 7};C{n};25,0;25,01\n" for n in range(100_000))
    yield "100,000 unknown characteristics", "l.csv", ("Teil;Merkmal;Soll;Ist\nP0;rack_over_roller [mm];25,0;25,01\n" + rows).encode()
    values = "".join(f"K0001/1 25.{n % 300:04}\nK0014/1 P{n:07}\n" for n in range(1_000_000))
    head = "K0100 1\nK2001/1 rack_over_roller\nK2002/1 rack_over_roller\nK2142/1 mm\n"
    yield "a million named values in Q-DAS", "m.dfq", (head + values).encode()
    yield from inputs_as_a_whole()
    cells = lambda row: [(place, f"c{place}" if row == 0 else "1") for place in places(16_000)]
    first = lambda row: [("A", "part_id"), ("B", "rack_over_roller [mm]")] if row == 0 else [("A", f"P{row}"), ("B", "25.01")]
    yield "16,000 columns in a workbook", "a.xlsx", workbook(first(row) + cells(row)[2:] for row in range(80))
    rows = ([*first(row), ("C", "c" if row == 0 else "1")] for row in range(400_000))
    yield "400,000 rows in a workbook", "b.xlsx", workbook(rows)
    yield "headings of 100,000 columns", "y.csv", ("part_id;rack_over_roller [mm]" + ";c" * 100_000 + "\nP1;25,01" + ";1" * 100_000 + "\n").encode()
    wide = "part_id;rack_over_roller [mm]" + "".join(f";c{n}" for n in range(16_000)) + "\n"
    yield "1,800 rows of 16,000 columns", "z.csv", (wide + ("P1;25,01" + ";1" * 16_000 + "\n") * 1800).encode()
    for teeth, name in (("3", "n.toml"), ("{}", "o.toml")):
        each = "".join(f'[[rack.deviation]]\nteeth = {teeth.format(n % 20)}\nshift = "{n % 7} nm"\n' for n in range(30_000))
        yield f"30,000 deviations of tooth {teeth.format('0 to 19')}", name, (PAIR + each).encode(), 128
    unknown = "".join(f"key_{n} = {n}\n" for n in range(200_000))
    yield "200,000 unknown keys", "p.toml", ("[pair]\n" + unknown).encode(), 128


def places(count):
    """The first columns of a sheet: A, B, …, AA, …"""
    for number in range(1, count + 1):
        place = ""
        while number:
            number, letter = divmod(number - 1, 26)
            place = chr(65 + letter) + place
        yield place


def inputs_as_a_whole():
    """Tables that are kept in memory, some just below and some far above the number of cells that is read."""
    def across(parts, rows):
        lines = ("Teil;" + ";".join(f"P{n}" for n in range(parts)), "rack_over_roller [mm]" + ";25,01" * parts)
        return "\n".join([*lines, *(f"c{n}" + ";1" * parts for n in range(rows))]).encode()

    def by_value(rows, name):
        lines = (f"P{n};{name.format(n)};25;25,01;,1;-,1;0;1\n" for n in range(rows))
        return ("Teil;Merkmal;Soll;Ist;OT;UT;Abw;x\n" + "".join(lines)).encode()

    yield "7.8 million cells, parts in columns", "aa.csv", across(7800, 1000)
    yield "590,000 cells, parts in columns", "ab.csv", across(1000, 588)
    yield "240,000 known characteristics", "ac.csv", by_value(240_000, "rack_over_roller [mm]")
    yield "74,000 known characteristics", "ad.csv", by_value(74_000, "rack_over_roller [mm]")
    yield "74,000 unknown characteristics", "ae.csv", by_value(74_000, "C{}")
    yield "800,000 aligned lines", "af.txt", b"part_id  rack_over_roller [mm]\n" + b"P1  25.01\n" * 800_000
    gaps = b"part_id  rack_over_roller [mm]  note\n" + b"P1       25.01                  x\n"
    yield "290,000 aligned lines with a gap", "ag.txt", gaps + b"P1       25.01\n" * 290_000
    yield "a long line below 400,000 short ones", "ah.csv", b"Teil;P1\nrack_over_roller [mm];25,01\n" + b"x\n" * 400_000 + b";" * 200_000 + b"x\n"
    head = "planid\tpartnb\tid\ttype\tidsymbol\tactual\tnominal\tuppertol\tlowertol\tdeviation\texceed\tunit\tcomment\n"
    row = "p\t{}\track_over_roller\tx\ty\t25.01\t25\t.1\t-.1\t.01\t\tmm\t\n"
    yield "280,000 rows of Calypso", "ai.txt", (head + "".join(row.format(n) for n in range(280_000))).encode()
    dimension = "PART NAME  : RACK\nDIM A= 2D DISTANCE UNITS=MM\nAX NOMINAL +TOL -TOL MEAS DEV\nM 1 2 3 4 5\n"
    yield "a million axes of PC-DMIS", "aj.txt", (dimension + "M 1 2 3 4 5\n" * 1_000_000).encode()
    yield "a million headings of PC-DMIS", "ak.txt", (dimension + "".join(f"AX MEAS q{n}\n" for n in range(1_000_000))).encode()
    yield "seven million words in PC-DMIS", "al.txt", (dimension + "w\n" * 7_000_000).encode()
    head = "K0100 1\nK2001/1 c{0}\nK2002/1 name{0}\nK2142/1 mm\n25.01\n"
    yield "99,000 headers in Q-DAS", "am.dfq", "".join(head.format(n) for n in range(99_000)).encode()
    teeth = "part_id;space;over_pin_deviation [mm]\n"
    yield "3.5 million parts of a tooth", "teeth-a.csv", (teeth + "".join(f"P{n};0;0,01\n" for n in range(3_500_000))).encode()
    yield "3,000 parts with long names", "teeth-b.csv", (teeth + "".join(f"P{n}{'x' * 20_000};0;0,01\n" for n in range(3000))).encode()
    yield "4.5 million teeth of a part", "teeth-c.csv", (teeth + "".join(f"P;{n % 90_000};0,01\n" for n in range(4_500_000))).encode()
    head = b"part_id;rack_over_roller [mm]\n"
    yield "a million rows that are all rejected", "an.csv", head + b"".join(b"P%d;x\n" % n for n in range(1_000_000))
    yield "cells of 250 kB in Latin-1", "ao.csv", head + (b"\xe4" * 250_000 + b";x\n") * 240
    yield "2.5 million names of words in Latin-1", "ap.csv", head + b"St\xfcck;25,01\n" * 2_500_000
    rows = b"".join(b"P%d;25,01\n" % n for n in range(50))
    yield "200 long rows that are no parts", "read-c.csv", head + rows + (b"x" * 200_000 + b";\n") * 200
    words = b"some words and no table\n" * (64 << 20 >> 5)
    yield "48 MiB of words through a pipe", "read-a.txt", words
    yield "64 MiB and more through a pipe", "read-b.txt", words * 2
    yield "words for a page through a pipe", "report-a.txt", words


def resident(pid):
    """Peak resident memory of a running program, MiB."""
    try:
        lines = open(f"/proc/{pid}/status").read().split("\n")
    except OSError:
        return 0
    name = [line for line in lines if line.startswith("Name:")]
    if not name or "python" in name[0]:
        return 0
    return max((int(line.split()[1]) / 1024 for line in lines if line.startswith("VmHWM")), default=0)


def arguments(spec, pair, path):
    """The command for a file: by the start of its name, or by its ending."""
    name = os.path.basename(path)
    commands = {"teeth-": ["batch", "--teeth", pair, path], "read-": ["read", "--spec", spec, "-"], "report-": ["report", spec, "-"]}
    for start, command in commands.items():
        if name.startswith(start):
            return command
    return ["eval", path] if name.endswith(".toml") else ["batch", spec, path]


def run(program, command, path, limit):
    begun = time.monotonic()
    with open(os.devnull, "wb") as none, open(path, "rb") as given, tempfile.TemporaryFile() as said:
        child = subprocess.Popen([program, *command], stdin=given, stdout=none, stderr=said)
        peak = 0
        while True:
            peak = max(peak, resident(child.pid))
            pid, status, used = os.wait4(child.pid, os.WNOHANG)
            if pid:
                break
            if time.monotonic() - begun > limit:
                child.send_signal(signal.SIGTERM)
                ended = time.monotonic()
                _, status, used = os.wait4(child.pid, 0)
                late = time.monotonic() - ended
                return limit, peak, f"ended by a signal after {late:.2f} s", late <= 1
            time.sleep(0.002)
        child.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        first = said.read(300).decode("utf8", "replace").split("\n")[0]
        seconds = used.ru_utime + used.ru_stime
        return seconds, peak, f"exit {child.returncode}: {first[:90]}", child.returncode in (0, 1, 2)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("--seconds", type=float, default=2)
    parser.add_argument("--mib", type=float, default=64)
    args = parser.parse_args()
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        spec = os.path.join(folder, "spec.toml")
        open(spec, "w").write(SPEC)
        pair = os.path.join(folder, "pair.toml")
        open(pair, "w").write(PAIR)
        for what, name, data, *mib_of_input in inputs():
            path = os.path.join(folder, name)
            open(path, "wb").write(data)
            seconds, mib, said, is_clean = run(args.program, arguments(spec, pair, path), path, 60)
            is_held = is_clean and seconds <= args.seconds and mib <= max([args.mib, *mib_of_input])
            failed += not is_held
            print(f"{'ok  ' if is_held else 'MISS'} {what}: {len(data) / 1e6:.1f} MB, {seconds:.2f} s, {mib:.0f} MiB, {said}", flush=True)
    sys.exit(failed > 0)


main()
