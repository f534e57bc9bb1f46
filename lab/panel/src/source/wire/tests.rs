//! Streams in pieces of any size, and broken ones.

use super::*;
use sixaxis_recordings::unit::STANDARD_GRAVITY_M_S2;

const HEAD: &str = "sixaxis rate=1000 format=f64\n";

fn read(bytes: &[u8], piece: usize) -> (Batch, Vec<WireError>, Result<(), WireError>) {
    let mut wire = Wire::new(&Channels::default());
    let (mut batch, mut refused) = (Batch::default(), Vec::new());
    for part in bytes.chunks(piece) {
        if let Err(error) = wire.take(part, &mut batch, &mut |e| refused.push(e)) {
            return (batch, refused, Err(error));
        }
    }
    (batch, refused, Ok(()))
}

#[test]
fn law_pieces_of_any_size_are_the_same_samples() {
    let numbers: Vec<f64> = (0..9 * 50).map(|k| f64::from(k) * 0.1).collect();
    let mut bytes = HEAD.as_bytes().to_vec();
    bytes.extend(numbers.iter().flat_map(|n| n.to_le_bytes()));
    let (whole, _, done) = read(&bytes, bytes.len());
    assert_eq!((done, whole.samples()), (Ok(()), 50));
    assert_eq!(whole.voltage_v.row(49)[8], f64::from(449) * 0.1);
    for piece in [1, 7, 72, 100] {
        assert_eq!(read(&bytes, piece).0, whole);
    }
}

#[test]
fn law_units_and_names_are_those_of_recordings() {
    let text = "sixaxis rate=1e3 format=text columns=gyroscope[deg/s],u9[mV],u8,u7,u6,u5,u4,u3,u2,u1,other,accelerometer[g]\n180,1000,2,3,4,5,6,7,8,9,77,1\n";
    let (batch, refused, done) = read(text.as_bytes(), 10);
    assert_eq!((done, refused.len()), (Ok(()), 0));
    assert_eq!(
        batch.voltage_v.row(0),
        [9.0, 8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0]
    );
    assert!((batch.standard[1][0] - core::f64::consts::PI).abs() < 1e-12);
    assert!((batch.standard[0][0] - STANDARD_GRAVITY_M_S2).abs() < 1e-12);
}

#[test]
fn law_a_broken_row_of_text_costs_that_row_alone() {
    let text = "sixaxis rate=1000 format=text\n1 2 3 4 5 6 7 8 9\n1 2 3\nx,2,3,4,5,6,7,8,9\n# a remark\n9,8,7,6,5,4,3,2,1\n";
    let (batch, refused, done) = read(text.as_bytes(), 5);
    assert_eq!((done, batch.samples(), refused.len()), (Ok(()), 2, 2));
    assert!(matches!(&refused[1], WireError::Row { line: 4, cause } if cause.contains("\"x\"")));
}

#[test]
fn law_heads_that_are_none_are_refused() {
    for (head, part) in [
        ("GET / HTTP/1.1\n", "sixaxis"),
        ("sixaxis\n", "rate"),
        ("sixaxis rate=-1\n", "rate"),
        ("sixaxis rate=nan\n", "rate"),
        ("sixaxis rate=1e300\n", "rate"),
        ("sixaxis rate=1000 format=f16\n", "format"),
        ("sixaxis rate=1000 colour=red\n", "keys"),
        ("sixaxis rate=1000 columns=u1,u2\n", "u3"),
        (
            "sixaxis rate=1000 columns=u1,u1,u2,u3,u4,u5,u6,u7,u8,u9\n",
            "twice",
        ),
        (
            "sixaxis rate=1000 columns=u1[g],u2,u3,u4,u5,u6,u7,u8,u9\n",
            "u1",
        ),
        (
            "sixaxis rate=1000 columns=u1,u2,u3,u4,u5,u6,u7,u8,u9,accelerometer,gyroscope[deg/h]\n",
            "deg/h",
        ),
    ] {
        match read(head.as_bytes(), 3).2 {
            Err(WireError::Head(cause)) => assert!(cause.contains(part), "{head}: {cause}"),
            other => panic!("{head}: {other:?}"),
        }
    }
    let endless = vec![b'a'; LONGEST_LINE + 2];
    assert_eq!(read(&endless, 100).2, Err(WireError::Endless { line: 1 }));
}

#[test]
fn prop_no_bytes_make_it_panic() {
    let mut state = 7_u64;
    let mut byte = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) as u8
    };
    for round in 0..1_000 {
        let mut bytes = match round % 4 {
            0 => Vec::new(),
            1 => HEAD.as_bytes().to_vec(),
            2 => b"sixaxis rate=1000 format=text\n".to_vec(),
            _ => b"sixaxis rate=1000 format=f32\n".to_vec(),
        };
        bytes.extend((0..usize::from(byte())).map(|_| byte()));
        let _ = read(&bytes, 1 + usize::from(byte()));
    }
}
