#!/bin/busybox sh
# The first process of the guest of `cargo xtask rig`. Results go to /out, which leaves as an archive through the
# second serial port. The first port tells the host the progress: each `done` makes the host unplug the part and plug
# in the next.
/bin/busybox --install -s /bin
export PATH=/bin
mkdir -p /dev /proc /sys /tmp /out
mount -t devtmpfs dev /dev
mount -t proc proc /proc
mount -t sysfs sys /sys

SPI=/sys/bus/spi
PART=spi-PRP0001:00
IIO=/sys/bus/iio/devices/iio:device0
ADDRESS="spi:/dev/spidev0.0?rdy=gpiochip0:3&hz=4800000"

say() { echo "RIG $*"; }

until_there() {
    i=0
    while [ ! -e "$1" ]; do
        i=$((i + 1))
        [ $i -gt 200 ] && say "failed: no $1" && dmesg | tail -20 && poweroff -f
        usleep 100000
    done
}

# The adapter's driver suspends the adapter after 10 ms without traffic, and then misses edges.
keep_awake() { echo on > /sys/bus/usb/devices/1-1/power/control; }

finished() {
    say "$1 done"
    while [ -e $SPI/devices/$PART ]; do usleep 50000; done
}

as_spidev() {
    until_there $SPI/devices/$PART
    keep_awake
    echo spidev > $SPI/devices/$PART/driver_override
    echo $PART > $SPI/drivers/spidev/bind
    until_there /dev/spidev0.0
    until_there /dev/gpiochip0
}

# run NAME ARGUMENTS…: keeps what the program prints, and how it ended.
run() {
    name=$1
    shift
    zerorate "$@" > /out/$name.json 2> /out/$name.err
    echo $? > /out/$name.code
    say "$name ended with $(cat /out/$name.code)"
}

for module in $(cat /lib/modules/order); do insmod /lib/modules/$module; done
uname -r > /out/kernel
say "booted $(uname -r)"

# (a) the kernel's own driver
until_there $IIO
keep_awake
for file in name in_anglvel_z_scale in_anglvel_z_offset in_temp0_scale in_temp0_offset; do
    cat $IIO/$file > /out/iio.$file
done
i=0
while [ $i -lt 50 ]; do
    cat $IIO/in_anglvel_z_raw >> /out/iio.rate
    cat $IIO/in_temp0_raw >> /out/iio.temp
    i=$((i + 1))
done
run iio probe --device "iio:iio:device0?hz=50" --duration 2s --json
rmmod adis16130

# (b) the HID gyroscope, through its own driver: through the buffer, while the wall clock steps back; polled; when it
# falls silent; when it is unplugged
gyro /out/hid.sent &
gyro=$!
until_there $IIO/scan_elements/in_timestamp_type
for file in name in_anglvel_scale in_anglvel_offset in_anglvel_sampling_frequency; do
    cat $IIO/$file > /out/hid.$file
done
cat $IIO/scan_elements/in_anglvel_z_type > /out/hid.in_anglvel_z_type
(sleep 2; date -s @1000000000) > /dev/null &
run hid capture --device iio:iio:device0 --duration 5s -o /out/hid.arrows --json
run hidprobe probe --device iio:iio:device0 --part /gyro.toml --duration 2s --json
run hidpolled capture --device "iio:iio:device0?hz=50" --part /gyro.toml --duration 2s -o /out/hidpolled.arrows --json
(until_there /out/hidsilent.arrows; sleep 2; kill -STOP $gyro) &
run hidsilent capture --device iio:iio:device0 --duration 60s -o /out/hidsilent.arrows --json
kill -CONT $gyro
# a second program opens the gyroscope while it is captured
(until_there /out/hidcut.arrows; run hidbusy probe --device iio:iio:device0 --json; sleep 2; kill $gyro) &
run hidcut capture --device iio:iio:device0 --duration 60s -o /out/hidcut.arrows --json
finished iio

# (c) the program on spidev and the GPIO chip: at a rate that the emulated bus can follow, and at one that it cannot
as_spidev
run probe probe --device "$ADDRESS&mclk=$SLOW_HZ" --duration 3s --json
run bytes probe --device "$ADDRESS&mclk=$SLOW_HZ&framing=byte" --duration 2s --json
for name in slow1 slow2 slow3; do
    run $name capture --device "$ADDRESS&mclk=$SLOW_HZ" --duration 6s -o /out/$name.arrows --json
done
finished spi

as_spidev
run fast capture --device "$ADDRESS&mclk=$FAST_HZ" --duration 5s -o /out/fast.arrows --json
finished fast

as_spidev
run calibrate calibrate --device "$ADDRESS&mclk=$SLOW_HZ" $PLAN --log /out/calibrate.arrows -o /out/unit.toml --json
finished calibrate

# (d) unplugged in mid-capture, and plugged in again
as_spidev
run cut capture --device "$ADDRESS&mclk=$SLOW_HZ" --duration 60s -o /out/cut.arrows --json &
until_there /out/cut.arrows
sleep 3
finished cut
wait
as_spidev
run replug probe --device "$ADDRESS&mclk=$SLOW_HZ" --duration 2s --json

stty -F /dev/ttyS1 raw
tar -cf - -C /out . > /dev/ttyS1
say "all done"
poweroff -f
