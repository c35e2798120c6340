//! Q-DAS files: any bytes are read or refused, every row has a cell per column, and values are numbers.

/// Reads the input as a file of statistics software.
pub fn check(data: &[u8]) {
    let text = rackmesh::cmm::decode(data);
    let Ok(qdas) = rackmesh::cmm::qdas::read(&[("fuzz.dfq", &text)]) else { return };
    let table = qdas.table(&[]);
    for row in 0..table.len().min(1000) {
        let cells = table.row(row);
        assert_eq!(cells.len(), table.columns.len());
        assert!(cells[1..].iter().all(|cell| cell.is_empty() || cell.parse::<f64>().is_ok()), "{cells:?}");
    }
}
