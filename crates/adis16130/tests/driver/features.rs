//! Tests the data types with the features `serde` and `defmt`.

#[cfg(feature = "serde")]
mod stored {
    use adis16130::registers::{Address, ConversionTime, Mode, Range};
    use adis16130::{
        ChannelStatus, Channels, Config, Edge, Fault, Framing, Mismatch, NoReading, OutOfRange, PollInterval,
        RateCode, RdyEdge, Sample, SamplerConfig, SelfTest, SelfTestPlan, TempCode, WaitBound, Width,
    };
    use serde::{Serialize, de::DeserializeOwned};
    use std::fmt::Debug;
    use std::num::NonZeroU32;

    fn there_and_back<T: Serialize + DeserializeOwned + PartialEq + Debug>(value: &T) -> String {
        let text = serde_json::to_string(value).unwrap();
        assert_eq!(&serde_json::from_str::<T>(&text).unwrap(), value, "{text}");
        text
    }

    #[test]
    fn a_sample_comes_back_as_it_was() {
        let sample = Sample {
            t_ns: u64::MAX,
            seq: 7,
            rate: RateCode::new(0x81_2345, Width::Bits24),
            status: Some(ChannelStatus::new(0x08)),
            temp: Some(TempCode::new(0x8123, Width::Bits16)),
            lost: 3,
        };
        let text = there_and_back(&sample);
        assert_eq!(
            text,
            r#"{"t_ns":18446744073709551615,"seq":7,"rate":{"code":8463173,"width":"Bits24"},"status":8,"#.to_owned()
                + r#""temp":{"code":33059,"width":"Bits16"},"lost":3}"#
        );
        there_and_back(&Edge { t_ns: 1, seq: 2 });
    }

    #[test]
    fn a_code_that_does_not_fit_is_refused() {
        for text in [r#"{"code":16777216,"width":"Bits24"}"#, r#"{"code":65536,"width":"Bits16"}"#] {
            let error = serde_json::from_str::<RateCode>(text).unwrap_err().to_string();
            assert!(error.contains("does not fit its width"), "{error}");
            serde_json::from_str::<TempCode>(text).unwrap_err();
        }
        let most = serde_json::from_str::<TempCode>(r#"{"code":65535,"width":"Bits16"}"#).unwrap();
        assert_eq!(most, TempCode::new(65_535, Width::Bits16));
    }

    #[test]
    fn a_configuration_is_stored_as_the_arguments_of_its_builders() {
        assert_eq!(serde_json::from_str::<Config>("{}").unwrap(), Config::new());
        assert!(serde_json::from_str::<Config>(r#"{"mode":42}"#).is_err());
        let all = Config::new()
            .with_width(Width::Bits16)
            .with_rate_conversion(ConversionTime::new(0x91))
            .with_temp_conversion(ConversionTime::new(0x7F))
            .with_range(Range::Bits01)
            .with_rdyfn(false)
            .with_sync(true)
            .with_clamp(true)
            .with_framing(Framing::Command)
            .with_rdy_edge(RdyEdge::Rising);
        there_and_back(&all);
        for channels in [Channels::Both, Channels::Rate, Channels::Temp] {
            there_and_back(&all.with_channels(channels));
            there_and_back(&Config::new().with_channels(channels));
        }
    }

    #[test]
    fn settings_results_and_evidence_come_back() {
        there_and_back(&SamplerConfig::new().with_every_temp(57).with_divider(2).with_read_status(false));
        let poll = PollInterval::from_us(NonZeroU32::new(20).unwrap());
        there_and_back(&WaitBound::from_us(2_000).with_poll(poll));
        let plan = there_and_back(&SelfTestPlan::new(6_000).with_settle_us(5));
        assert!(serde_json::from_str::<SelfTestPlan>(&plan.replace("375", "0")).is_err(), "{plan}");
        there_and_back(&SelfTest { shift_dps: 20.5, u_dps: 0.25, n: 6_000 });
        there_and_back(&Fault::StuckLow(Mismatch { register: Address::TempStatus, expected: 0x40, got: 0 }));
        there_and_back(&NoReading { register: Address::RateData, mode: Mode::new(0x22) });
        let status = Some(ChannelStatus::new(0x09));
        there_and_back(&OutOfRange { register: Address::RateData, code: 5, width: Width::Bits24, status });
    }
}

#[cfg(feature = "defmt")]
mod formatted {
    use adis16130::{frame::Frame, registers::*, *};

    fn all<T: defmt::Format>() {}

    #[test]
    fn every_public_type_has_a_format() {
        all::<(Config, Channels, RdyEdge, Framing, Width, Frame, Write)>();
        all::<(RateCode, TempCode, Edge, Sample, Due, SamplerConfig)>();
        all::<(Address, Size, Iop, Revision, AdcStatus, ChannelStatus, ChannelSetup)>();
        all::<(ConversionTime, Mode, Operation, Range, Checksum, WriteCheck)>();
        all::<(SelfTest, SelfTestPlan, WaitBound, PollInterval)>();
        all::<(Fault, Mismatch, Differences, OutOfRange, NoReading)>();
        all::<(BusError<u8>, ReadError<u8>, InitError<u8>, VerifyError<u8>, SampleError<u8>)>();
        all::<(WaitError<u8, u8>, SelfTestError<u8, u8, u8>, Error<u8>, Error<u8, u8, u8>)>();
    }
}
