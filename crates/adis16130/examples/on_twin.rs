//! Reads the twin, a simulated part, without any hardware. On a board `spi`, `rdy` and `delay` come from your HAL.

use adis16130::{Config, WaitBound, blocking::Adis16130};
use adis16130_twin::{Spec, Twin};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let twin = Twin::new(Spec::from_seed(1));
    let (spi, rdy, mut delay) = (twin.spi(), twin.rdy(), twin.delay());

    let mut gyro = Adis16130::new(spi, rdy, Config::new());
    gyro.restart()?;
    for _ in 0..5 {
        gyro.wait_ready(&mut delay, WaitBound::from_us(2_000))?;
        let (rate, temp) = gyro.read_in_range()?;
        println!("{:+.3} °/s at {:.2} °C", rate.to_dps(), temp.to_celsius());
    }
    Ok(())
}
