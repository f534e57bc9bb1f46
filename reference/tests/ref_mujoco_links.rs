//! The MuJoCo library that the build found or fetched is loaded, and is the one that the bindings were made for.

use sixaxis_reference::mujoco::version;

#[test]
fn the_library_in_use_is_the_pinned_one() {
    assert_eq!(version(), "3.17.0");
    mujoco_rs::util::assert_mujoco_version();
}
