use super::*;
use crate::random::Random;

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
    with_best!(Wide => same::<Wide>());
}

/// Every operation in turn, over numbers of all kinds.
fn all_operations<L: Lanes>(numbers: &[[f32; 8]]) -> Vec<[u32; 8]> {
    let mut out = Vec::new();
    for pair in numbers.windows(3) {
        let [a, b, c] = [L::load(&pair[0]), L::load(&pair[1]), L::load(&pair[2])];
        let mut sum = a;
        sum += b;
        let mut rest = a;
        rest -= b;
        let results = [a + b, a - b, a * b, a / b, -a, sum, rest, a.abs(), a.sqrt(), a.min(b), a.max(b)];
        let masks = [a.lt(b), a.le(b), a.gt(b), a.ge(b), a.eq(b), !a.lt(b), a.lt(b) & b.lt(c)];
        let more = [a.power_of_two(), a.sign(), a.clamp(-b.abs(), b.abs()), L::default(), L::splat(1.5)];
        out.extend(results.into_iter().chain(more).map(|x| x.eight().map(f32::to_bits)));
        out.extend(masks.map(|mask| L::select(mask | c.eq(a), b, c).eight().map(f32::to_bits)));
        out.extend(masks.map(|mask| [mask.bits(); 8]));
    }
    out
}

/// Instructions that the processor has and the target lacks change no bit; `Lanes` has the operations.
#[test]
fn all_operations_are_the_same_bits_with_the_instructions_of_the_processor() {
    let (mut random, count) = (Random(3), if cfg!(miri) { 3 } else { 300 });
    let mut numbers: Vec<[f32; 8]> =
        (0..count).map(|_| std::array::from_fn(|_| f32::from_bits(random.bits() as u32))).collect();
    numbers.extend((0..8).map(|shift| std::array::from_fn(|i| ODD[(i * (shift + 1)) % 8])));
    let known = all_operations::<f32x8>(&numbers);
    let found = with_best!(Wide => all_operations::<Wide>(&numbers));
    for (i, (known, found)) in known.iter().zip(&found).enumerate() {
        for (known, found) in known.iter().zip(found) {
            let none = |bits: u32| f32::from_bits(bits).is_nan();
            assert!(known == found || none(*known) && none(*found), "{i}: {known:x} and {found:x}");
        }
    }
}

kernel! {
    fn sum_of_records<'a, L: GatherLanes>(records: &'a [Record], index: &'a [u32; 8]) -> [Record; 8] {
        let (v, w) = gather::<L>(|i| records[i], index);
        scatter(v + w, w)
    }
}

#[test]
fn records_are_gathered_alike_with_the_instructions_of_the_processor() {
    let records: Vec<Record> = (0..20u8)
        .map(|i| Record {
            linear: glam::vec3(f32::from(i), 0.5, -1.0 - f32::from(i)),
            angular: glam::vec3(100.0, 200.0 + f32::from(i), 300.0),
            ..Record::default()
        })
        .collect();
    let index = [3, 1, 19, 0, 7, 7, 2, 9];
    let found = with_best!(Wide => sum_of_records::<Wide>(&records, &index));
    assert_eq!(found, sum_of_records::<f32x8>(&records, &index));
    for (found, i) in found.iter().zip(index) {
        let record = &records[i as usize];
        assert_eq!(found.linear, record.linear + record.angular);
        assert_eq!(found.angular, record.angular);
    }
}
