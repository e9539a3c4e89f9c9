mod common;
use bevy::prelude::*;
use bevy_cloth::*;
use common::*;
#[test]
fn subs() {
    let mut app = headless();
    let c = app.world_mut().spawn((Cloth::rectangle(2.0, 1.5), Pins::rods(5), ClothStats::default())).id();
    let d = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(31,31), Pins::corners(), ClothStats::default())).id();
    for _ in 0..20 { run(&mut app, 10); println!("{:?} {:?}", get::<ClothStats>(&app, c), get::<ClothStats>(&app, d)); }
}
