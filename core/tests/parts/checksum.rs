//! CRC-32: what only the crate itself can see.

use super::Crc;

/// The check value of the catalogue of CRC algorithms.
#[test]
fn check_value() {
    assert_eq!(Crc::new().add(b"123456789").finish(), 0xcbf4_3926);
    assert_eq!(Crc::new().add(b"1234").add(b"56789").finish(), 0xcbf4_3926);
    assert_eq!(Crc::new().finish(), 0);
}
