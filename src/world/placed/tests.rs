//! Lamps for tests, and tests of them.

use proptest::prelude::*;

use super::*;

const AXES: [IVec3; 3] = [IVec3::X, IVec3::NEG_Y, IVec3::NEG_Z];

/// Lamps as a player could place them.
pub fn lamps() -> impl Strategy<Value = Vec<PlacedLamp>> {
    let voxel = (-40..40i32, -40..40i32, -40..40i32).prop_map(IVec3::from);
    let block = (
        prop::sample::select(&LampForm::ALL[..]),
        prop::sample::select(&LampColour::ALL[..]),
        POWERS,
        RADII,
        prop_oneof![Just(0.0), SOFT_RADII],
        prop::sample::select(&LampMotion::ALL[..]),
    );
    let block = block.prop_map(
        |(form, colour, power, radius, soft_radius, motion)| LampBlock {
            form,
            colour,
            power,
            radius,
            soft_radius,
            motion,
        },
    );
    let lamp = (voxel, block, prop::sample::select(&AXES[..]), any::<bool>());
    let lamp = lamp.prop_map(|(voxel, block, towards, is_on)| PlacedLamp {
        voxel,
        block,
        towards,
        is_on,
    });
    prop::collection::vec(lamp, 0..12).prop_map(|all| {
        let mut lamps = Vec::new();
        for lamp in all {
            put(&mut lamps, lamp.voxel, Some(lamp));
        }
        lamps
    })
}

/// A lamp of the default kind.
pub fn lamp(voxel: IVec3) -> PlacedLamp {
    PlacedLamp {
        voxel,
        block: LampBlock::default(),
        towards: IVec3::Y,
        is_on: true,
    }
}

proptest! {
    #[test]
    fn placed_lamps_have_no_fault_and_a_voxel_has_one(lamps in lamps(), again in lamps()) {
        prop_assert_eq!(fault(&lamps), None);
        let mut changed = lamps.clone();
        for lamp in &again {
            put(&mut changed, lamp.voxel, Some(*lamp));
            prop_assert_eq!(at(&changed, lamp.voxel), Some(lamp));
        }
        prop_assert_eq!(fault(&changed), None);
        for lamp in &again {
            put(&mut changed, lamp.voxel, None);
            prop_assert_eq!(at(&changed, lamp.voxel), None);
        }
        prop_assert!(changed.iter().all(|lamp| lamps.contains(lamp)));
    }
}

#[test]
fn what_no_player_places_is_a_fault() {
    let good = lamp(IVec3::ONE);
    let change = |change: fn(&mut PlacedLamp)| {
        let mut lamp = good;
        change(&mut lamp);
        fault(&[lamp])
    };
    assert_eq!(change(|_| ()), None);
    assert!(change(|lamp| lamp.voxel.y = FARTHEST as i32 + 1).is_some());
    assert!(change(|lamp| lamp.towards = IVec3::ZERO).is_some());
    assert!(change(|lamp| lamp.towards = IVec3::new(1, 1, 0)).is_some());
    assert!(change(|lamp| lamp.towards = IVec3::X * i32::MIN).is_some());
    assert!(change(|lamp| lamp.block.power = f32::NAN).is_some());
    assert!(change(|lamp| lamp.block.power = 1e30).is_some());
    assert!(change(|lamp| lamp.block.radius = 0.0).is_some());
    assert!(change(|lamp| lamp.block.soft_radius = 1.5).is_none());
    assert!(change(|lamp| lamp.block.soft_radius = 1.6).is_some());
    assert!(change(|lamp| lamp.block.soft_radius = -0.1).is_some());
    assert!(change(|lamp| lamp.block.soft_radius = f32::NAN).is_some());
    let twins = fault(&[good, good]).expect("a fault");
    assert!(twins.contains("one voxel"), "{twins}");
    let many: Vec<_> = (0..=MOST_PLACED as i32)
        .map(|x| lamp(IVec3::X * x))
        .collect();
    assert!(fault(&many).is_some() && fault(&many[1..]).is_none());
}

#[test]
fn a_spot_shines_away_from_its_face_and_power_is_by_the_metre() {
    let mut lamp = lamp(IVec3::new(-3, 0, 7));
    lamp.block.form = LampForm::Spot;
    lamp.towards = IVec3::NEG_Z;
    let spot = lamp.lamp(2.0);
    assert_eq!(spot.position, Vec3::new(-2.5, 0.5, 7.5));
    assert_eq!(spot.power, lamp.block.power / 4.0);
    assert!(matches!(spot.kind, LampKind::Spot { direction, .. } if direction == Vec3::NEG_Z));
}

#[test]
fn a_point_is_written_as_before_there_were_spheres_and_a_sphere_with_its_radius() {
    let point = LampBlock::default();
    let text = serde_json::to_string(&point).expect("JSON");
    assert!(!text.contains("soft_radius"), "{text}");
    assert_eq!(serde_json::from_str::<LampBlock>(&text).ok(), Some(point));
    let sphere = LampBlock {
        soft_radius: 0.75,
        ..point
    };
    let text = serde_json::to_string(&sphere).expect("JSON");
    assert_eq!(serde_json::from_str::<LampBlock>(&text).ok(), Some(sphere));
    assert_ne!(sphere.name(), point.name());
    let mut lamp = lamp(IVec3::ONE);
    assert!(!lamp.lamp(1.0).is_sphere());
    lamp.block = sphere;
    assert_eq!(lamp.lamp(1.0).soft_radius, 0.75);
    assert!(lamp.lamp(1.0).is_sphere());
}
