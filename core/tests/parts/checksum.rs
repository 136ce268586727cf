//! CRC-32: what only the crate itself can see.

use super::crc;

/// The check value of the catalogue of CRC algorithms.
#[test]
fn check_value() {
    assert_eq!(crc([b"123456789"]), 0xcbf4_3926);
    assert_eq!(crc([b"1234", b"56789"]), 0xcbf4_3926);
    assert_eq!(crc([]), 0);
}
