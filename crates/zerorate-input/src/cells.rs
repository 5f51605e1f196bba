//! Converts columns of numbers to integers or to `f64`. A value that an integer type cannot hold is an error. An `f64`
//! may be rounded.

use arrow_array::cast::AsArray;
use arrow_array::types::{Decimal128Type, Float16Type, Float32Type, Float64Type};
use arrow_array::{Array, ArrowPrimitiveType, Float64Array, Int64Array, PrimitiveArray, downcast_integer_array};
use arrow_schema::{ArrowError, DataType};

/// The values as integers of the type `T`. Floating-point numbers must be whole. A timestamp or a duration becomes its
/// count in the unit of its column, such as milliseconds.
pub fn integers<T>(column: &dyn Array) -> Result<PrimitiveArray<T>, ArrowError>
where
    T: ArrowPrimitiveType<Native: TryFrom<i128>>,
{
    if let Some(same) = column.as_primitive_opt::<T>() {
        return Ok(same.clone());
    }
    downcast_integer_array! {
        column => { converted(column) }
        DataType::Float16 | DataType::Float32 | DataType::Float64 => {
            let numbers = floats(column)?;
            numbers.try_unary(|number| whole(number).and_then(fitting::<T>).ok_or_else(|| misfit::<T>(number)))
        }
        DataType::Timestamp(..) | DataType::Duration(_) => {
            let counts = column.to_data().into_builder().data_type(DataType::Int64).build()?;
            converted(&Int64Array::from(counts))
        }
        other => Err(ArrowError::CastError(format!("{other} is not a type of integers")))
    }
}

fn converted<S, T>(column: &PrimitiveArray<S>) -> Result<PrimitiveArray<T>, ArrowError>
where
    S: ArrowPrimitiveType<Native: Into<i128>>,
    T: ArrowPrimitiveType<Native: TryFrom<i128>>,
{
    column.try_unary(|value| {
        let value = value.into();
        fitting::<T>(value).ok_or_else(|| misfit::<T>(value))
    })
}

fn fitting<T: ArrowPrimitiveType<Native: TryFrom<i128>>>(integer: i128) -> Option<T::Native> {
    T::Native::try_from(integer).ok()
}

fn whole(number: f64) -> Option<i128> {
    (number.fract() == 0.0 && number.abs() < 2f64.powi(64)).then_some(number as i128)
}

fn misfit<T: ArrowPrimitiveType>(value: impl std::fmt::Display) -> ArrowError {
    ArrowError::CastError(format!("{value} does not fit the type {}", T::DATA_TYPE))
}

/// The values as `f64`, rounded to nearest. Returns an error if the column does not hold numbers.
pub fn floats(column: &dyn Array) -> Result<Float64Array, ArrowError> {
    downcast_integer_array! {
        column => { Ok(column.unary(|value| value as f64)) }
        DataType::Float64 => Ok(column.as_primitive::<Float64Type>().clone()),
        DataType::Float32 => Ok(column.as_primitive::<Float32Type>().unary(f64::from)),
        DataType::Float16 => Ok(column.as_primitive::<Float16Type>().unary(f64::from)),
        DataType::Decimal128(_, places) => {
            let unit = 10f64.powi((*places).into());
            Ok(column.as_primitive::<Decimal128Type>().unary(|value| value as f64 / unit))
        }
        other => Err(ArrowError::CastError(format!("{other} is not a type of numbers")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arrow_array::types::{Int32Type, UInt8Type, UInt64Type};
    use arrow_array::{Decimal128Array, DurationMillisecondArray, Float32Array, Int16Array, StringArray, UInt64Array};

    #[test]
    fn a_number_that_fits_stays_the_same() {
        let shorts = Int16Array::from(vec![Some(-3), None, Some(7)]);
        assert_eq!(
            integers::<Int32Type>(&shorts).expect("integers").iter().collect::<Vec<_>>(),
            [Some(-3), None, Some(7)]
        );
        assert_eq!(floats(&shorts).expect("numbers").values()[2], 7.0);
        let counted = DurationMillisecondArray::from(vec![1_000]);
        assert_eq!(integers::<UInt64Type>(&counted).expect("a count").value(0), 1_000);
        let whole = Float64Array::from(vec![Some(200.0), None]);
        assert_eq!(integers::<UInt8Type>(&whole).expect("whole").iter().collect::<Vec<_>>(), [Some(200), None]);
        let decimals = Decimal128Array::from(vec![-125]).with_precision_and_scale(5, 2).expect("decimals");
        assert_eq!(floats(&decimals).expect("numbers").value(0), -1.25);
    }

    #[test]
    fn a_number_that_does_not_fit_is_an_error() {
        let error = |column: &dyn Array| integers::<UInt8Type>(column).expect_err("no fit").to_string();
        assert!(error(&Int16Array::from(vec![300])).contains("300"));
        assert!(error(&Float32Array::from(vec![0.5])).contains("0.5"));
        assert!(error(&Float64Array::from(vec![f64::NAN])).contains("NaN"));
        assert!(error(&UInt64Array::from(vec![u64::MAX])).contains("UInt8"));
        assert!(error(&StringArray::from(vec!["5"])).contains("Utf8"));
        assert!(floats(&StringArray::from(vec!["5"])).is_err());
    }
}
