//! Pasted blocks: any text is understood, or refused with a reason; what is understood says how.

use rackmesh::cmm::paste::{Pasted, Want, understand};
use rackmesh::deviation::ErrorKind;

/// Reads the input as a pasted block, with and without expectations.
pub fn check(data: &[u8]) {
    let text = rackmesh::cmm::decode(data);
    let plain = Want::default();
    let expecting = Want { expected: ErrorKind::ALL.to_vec(), module: "2".parse().ok(), ..Want::default() };
    for want in [plain, expecting] {
        match understand("fuzz.txt", &text, &want) {
            Ok(understood) => {
                assert!(!understood.account.to_string().is_empty());
                let count = match understood.pasted {
                    Pasted::Parts(parts) => parts.len(),
                    Pasted::Rack(rack) => rack.rows.len(),
                    Pasted::Pinion(pinion) => pinion.rows.len(),
                };
                assert_eq!(count, understood.account.count);
            }
            Err(diagnostic) => assert!(!diagnostic.to_string().is_empty()),
        }
    }
}
