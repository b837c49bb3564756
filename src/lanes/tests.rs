use super::*;

const ODD: [f32; 8] = [f32::NAN, 0.0, -0.0, f32::INFINITY, f32::NEG_INFINITY, 1.5, -2.25, f32::MIN_POSITIVE];

fn same<L: Lanes>() {
    for shift in 0..8 {
        for i in (0..8).step_by(L::N) {
            let at = |k: usize| (ODD[(i + k) % 8], ODD[(i + k + shift) % 8]);
            let a = L::from_fn(|k| at(k).0);
            let b = L::from_fn(|k| at(k).1);
            for k in 0..L::N {
                let (x, y) = at(k);
                assert_eq!(a.max(b).lane(k).to_bits(), (if x > y { x } else { y }).to_bits());
                assert_eq!(a.min(b).lane(k).to_bits(), (if x < y { x } else { y }).to_bits());
                assert_eq!(a.lt(b).bits() >> k & 1 != 0, x < y);
                assert_eq!(a.ge(b).bits() >> k & 1 != 0, x >= y);
                let chosen = L::select(a.gt(b), a, b).lane(k);
                assert_eq!(chosen.to_bits(), (if x > y { x } else { y }).to_bits());
            }
        }
    }
    let mask = L::Mask::from_bits(0b1010_0101);
    assert_eq!(mask.bits(), 0b1010_0101 & ((1u32 << L::N) - 1));
}

#[test]
fn comparisons_and_choices_are_the_same_bits_at_any_width() {
    same::<f32>();
    same::<f32x4>();
    same::<f32x8>();
}
