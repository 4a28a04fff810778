//! Files of mixtures: there and back, and hostile ones.

use undulate::{Component, Estimator, FourierMovementPrimitive, LearnOptions, Mixture, synthetic};

use crate::toy;

#[test]
fn a_mixture_comes_back_bit_for_bit() {
    let mixture = toy::labelled([6, 8], 3.0, Estimator::default());
    let text = mixture.to_json();
    assert_eq!(Mixture::from_json(&text).unwrap(), mixture);
    assert_eq!(Mixture::from_json(&text).unwrap().to_json(), text);
    assert!(Mixture::is_file(&text));
    // Neither is read for the other.
    let one = mixture.components()[0].primitive.to_json();
    assert!(!Mixture::is_file(&one) && Mixture::from_json(&one).is_err());
    let error = FourierMovementPrimitive::from_json(&text).unwrap_err();
    assert!(error.to_string().contains("undulate mixture"), "{error}");
}

#[test]
fn names_can_be_changed_and_not_given_twice() {
    let mixture = toy::labelled([6, 8], 3.0, Estimator::default());
    let renamed = mixture.renamed("small", "shy").unwrap();
    assert_eq!(
        renamed.component("shy").unwrap().primitive,
        mixture.component("small").unwrap().primitive
    );
    assert!(mixture.renamed("small", "large").is_err());
    assert!(mixture.renamed("nobody", "shy").is_err());
    assert!(mixture.renamed("small", "").is_err());
    assert!(mixture.renamed("small", "two\nlines").is_err());
}

#[test]
fn hostile_files_are_refused() {
    let text = toy::labelled([6, 8], 3.0, Estimator::default()).to_json();
    let weight = format!("\"weight\":{}", 6.0 / 14.0);
    assert!(text.contains(&weight));
    let damages = [
        ("\"undulate mixture\"", "\"undulate pudding\""),
        ("\"version\":1", "\"version\":0"),
        ("\"version\":1", "\"version\":7"),
        ("\"version\":1", "\"version\":1,\"extra\":1"),
        (&weight, "\"weight\":0.5"),
        (&weight, "\"weight\":-0.1"),
        (&weight, "\"weight\":1e400"),
        (&weight, "\"weight\":null"),
        ("\"name\":\"small\"", "\"name\":\"large\""),
        ("\"name\":\"small\"", "\"name\":\"\""),
        ("\"name\":\"small\"", "\"name\":7"),
        ("\"elbow\"", "\"knee\""),
        ("\"undulate model\"", "\"undulate mixture\""),
        ("\"version\":2", "\"version\":1"),
        ("\"period_s\":2.0", "\"period_s\":3.0"),
        ("\"period_s\":2.0", "\"period_s\":-2.0"),
        ("\"harmonics\":2", "\"harmonics\":1000000000000"),
        ("\"signed\"", "\"positive\""),
    ];
    for (from, to) in damages {
        let damaged = text.replacen(from, to, 1);
        assert_ne!(damaged, text, "{from}");
        let error = Mixture::from_json(&damaged).expect_err(to).to_string();
        println!("{to}: {error}");
    }
    let none = "{\"format\":\"undulate mixture\",\"version\":1,\"components\":[]}";
    assert!(Mixture::from_json(none).is_err());
    for end in (0..text.len() - 2).step_by(7) {
        assert!(Mixture::from_json(&text[..end]).is_err());
    }
}

#[test]
fn primitives_of_different_shape_make_no_mixture() {
    let component = |name: &str, primitive: &FourierMovementPrimitive| Component {
        name: name.to_owned(),
        weight: 0.5,
        primitive: primitive.clone(),
    };
    let of =
        |harmonics| FourierMovementPrimitive::learn(&synthetic(0).unwrap(), harmonics).unwrap();
    let (one, other) = (of(3), of(4));
    let error = Mixture::new(vec![component("one", &one), component("other", &other)]);
    let error = error.unwrap_err().to_string();
    assert!(
        error.contains("other") && error.contains("4 harmonics"),
        "{error}"
    );
    let toy =
        FourierMovementPrimitive::from_waves(&toy::waves([4, 4], 1.0, 0), &LearnOptions::default());
    assert!(
        Mixture::new(vec![
            component("one", &one),
            component("toy", &toy.unwrap())
        ])
        .is_err()
    );
    assert!(Mixture::new(vec![component("one", &one)]).is_err());
    assert!(Mixture::new(Vec::new()).is_err());
}
