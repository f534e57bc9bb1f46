//! placeholder
fn main() {
    println!("{}", sixaxis_reference::mjcf::mujoco_version());
}
