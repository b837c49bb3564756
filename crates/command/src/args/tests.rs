//! Tests of the options.

use super::*;

#[test]
fn the_command_line_is_consistent() {
    Options::command().debug_assert();
}

#[test]
fn numbers_are_read_as_people_write_them() {
    assert_eq!(seconds("1/60").unwrap(), 1.0 / 60.0);
    assert_eq!(seconds("0.02").unwrap(), 0.02);
    assert!(seconds("0").is_err() && seconds("1/0").is_err() && seconds("x").is_err());
    assert_eq!(gravity("1.62").unwrap(), Vec3::new(0.0, -1.62, 0.0));
    assert_eq!(gravity("1,-2,0.5").unwrap(), Vec3::new(1.0, -2.0, 0.5));
    assert_eq!(bytes("4096").unwrap(), 4096);
    assert_eq!(bytes("1.5 KiB").unwrap(), 1536);
    assert_eq!(bytes("12MiB").unwrap(), 12 << 20);
    assert!(bytes("12MB").is_err() && bytes("-1KiB").is_err() && bytes("1.5").is_err());
    // Beyond, memory ran out before the first step.
    assert!(crowd("1000000").is_ok() && crowd("99999999999").is_err() && crowd("-1").is_err());
    assert!(shots("1000000000").is_ok() && shots("18446744073709551615").is_err());
    assert!(gravity("1,2").is_err() && gravity("inf").is_err());
}
