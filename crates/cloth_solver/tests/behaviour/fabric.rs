//! The presets are cloth, and no invalid fabric is accepted.

use cloth_solver::{ClothError, Fabric};

/// What is not soft enough to fall in folds.
const NOT_CLOTH: [&str; 1] = ["Paper"];

#[test]
fn every_preset_is_valid_and_has_a_name_of_its_own() {
    assert_eq!(Fabric::PRESETS.len(), 14);
    for (i, (name, fabric)) in Fabric::PRESETS.iter().enumerate() {
        assert_eq!(fabric.validate(), Ok(()), "{name}");
        assert!(Fabric::PRESETS[..i].iter().all(|(n, f)| n != name && f != fabric), "{name}");
    }
    assert_eq!(Fabric::default(), Fabric::PRESETS[0].1);
}

#[test]
fn cloths_have_bending_lengths_of_three_quarters_to_four_centimetres_and_paper_more() {
    for (name, fabric) in Fabric::PRESETS {
        let length = fabric.bending_length();
        let is_cloth = length.min_element() >= 0.0075 && length.max_element() <= 0.04;
        assert_eq!(is_cloth, !NOT_CLOTH.contains(name), "{name}: {length} m");
    }
    assert!(Fabric::PAPER.bending_length().min_element() > 0.07);
}

#[test]
fn poplin_has_the_bending_length_of_the_closed_form() {
    // (8e-6 / (0.15 · 9.80665))^(1/3)
    assert!((Fabric::COTTON_POPLIN.bending_length().y - 0.017_588).abs() < 1e-5);
}

#[test]
fn an_invalid_number_is_refused_under_the_name_of_its_field() {
    let set: [(&str, fn(&mut Fabric, f32)); 11] = [
        ("Fabric::areal_density", |f, v| f.areal_density = v),
        ("Fabric::thickness", |f, v| f.thickness = v),
        ("Fabric::stretch_warp", |f, v| f.stretch_warp = v),
        ("Fabric::stretch_weft", |f, v| f.stretch_weft = v),
        ("Fabric::shear", |f, v| f.shear = v),
        ("Fabric::bend_warp", |f, v| f.bend_warp = v),
        ("Fabric::bend_weft", |f, v| f.bend_weft = v),
        ("Fabric::damping", |f, v| f.damping = v),
        ("Fabric::friction", |f, v| f.friction = v),
        ("Fabric::stretch_limit", |f, v| f.stretch_limit = v),
        ("Fabric::strength", |f, v| f.strength = v),
    ];
    for (name, set) in set {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 1e10] {
            let mut fabric = Fabric::default();
            set(&mut fabric, bad);
            let Err(ClothError::OutOfRange { field, .. }) = fabric.validate() else {
                panic!("{name} = {bad} was accepted");
            };
            assert_eq!(field, name);
        }
    }
}

#[test]
fn a_fabric_may_lack_shear_bending_damping_and_friction_but_not_stretch_or_mass() {
    let zero = Fabric { shear: 0.0, bend_warp: 0.0, bend_weft: 0.0, damping: 0.0, friction: 0.0, ..Fabric::VOILE };
    assert_eq!(zero.validate(), Ok(()));
    assert!(Fabric { stretch_warp: 0.0, ..Fabric::VOILE }.validate().is_err());
    assert!(Fabric { areal_density: 0.0, ..Fabric::VOILE }.validate().is_err());
}
