//! What a column of a table holds, and how a field of a record becomes that and back.

/// A value of a column. A database needs to know these four and nothing of records.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Value {
    /// Nothing; less than all others.
    Null,
    /// A number. What is more than `i64` has is kept by its bits.
    Number(i64),
    /// Bytes.
    Bytes(Vec<u8>),
    /// Text in UTF-8.
    Text(String),
}

/// What the values of a column are.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ColumnKind {
    /// [`Value::Number`].
    Number,
    /// [`Value::Bytes`].
    Bytes,
    /// [`Value::Text`].
    Text,
}

/// A type that a record may have a field of.
pub trait Field: Sized {
    /// Of its column.
    const KIND: ColumnKind;
    /// Whether its column may hold [`Value::Null`].
    const IS_NULLABLE: bool = false;

    /// The value that is kept.
    fn to_value(&self) -> Value;

    /// What was kept as this value; `None` where nothing was.
    fn from_value(value: &Value) -> Option<Self>;
}

macro_rules! small_numbers {
    ($($t:ident)*) => {$(
        impl Field for $t {
            const KIND: ColumnKind = ColumnKind::Number;

            fn to_value(&self) -> Value {
                Value::Number(i64::from(*self))
            }

            fn from_value(value: &Value) -> Option<Self> {
                let Value::Number(number) = value else { return None };
                $t::try_from(*number).ok()
            }
        }
    )*};
}

small_numbers! { u8 u16 u32 }

impl Field for u64 {
    const KIND: ColumnKind = ColumnKind::Number;

    fn to_value(&self) -> Value {
        Value::Number(self.cast_signed())
    }

    fn from_value(value: &Value) -> Option<Self> {
        let Value::Number(number) = value else { return None };
        Some(number.cast_unsigned())
    }
}

impl Field for bool {
    const KIND: ColumnKind = ColumnKind::Number;

    fn to_value(&self) -> Value {
        Value::Number(i64::from(*self))
    }

    fn from_value(value: &Value) -> Option<Self> {
        match value {
            Value::Number(0) => Some(false),
            Value::Number(1) => Some(true),
            _ => None,
        }
    }
}

impl Field for String {
    const KIND: ColumnKind = ColumnKind::Text;

    fn to_value(&self) -> Value {
        Value::Text(self.clone())
    }

    fn from_value(value: &Value) -> Option<Self> {
        let Value::Text(text) = value else { return None };
        Some(text.clone())
    }
}

impl Field for Vec<u8> {
    const KIND: ColumnKind = ColumnKind::Bytes;

    fn to_value(&self) -> Value {
        Value::Bytes(self.clone())
    }

    fn from_value(value: &Value) -> Option<Self> {
        let Value::Bytes(bytes) = value else { return None };
        Some(bytes.clone())
    }
}

impl<const N: usize> Field for [u8; N] {
    const KIND: ColumnKind = ColumnKind::Bytes;

    fn to_value(&self) -> Value {
        Value::Bytes(self.to_vec())
    }

    fn from_value(value: &Value) -> Option<Self> {
        let Value::Bytes(bytes) = value else { return None };
        bytes.as_slice().try_into().ok()
    }
}

impl<T: Field> Field for Option<T> {
    const KIND: ColumnKind = T::KIND;
    const IS_NULLABLE: bool = true;

    fn to_value(&self) -> Value {
        self.as_ref().map_or(Value::Null, Field::to_value)
    }

    fn from_value(value: &Value) -> Option<Self> {
        match value {
            Value::Null => Some(None),
            value => T::from_value(value).map(Some),
        }
    }
}

/// An enum of single cases that is kept as its number, which never changes.
macro_rules! stored_enum {
    (
        $(#[$about:meta])*
        pub enum $Name:ident { $($(#[$about_case:meta])* $Case:ident = $number:literal,)* }
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, PartialEq, Eq, Debug)]
        #[repr(u8)]
        pub enum $Name { $($(#[$about_case])* $Case = $number,)* }

        impl $crate::value::Field for $Name {
            const KIND: $crate::value::ColumnKind = $crate::value::ColumnKind::Number;

            fn to_value(&self) -> $crate::value::Value {
                $crate::value::Value::Number(*self as i64)
            }

            fn from_value(value: &$crate::value::Value) -> Option<Self> {
                match value {
                    $($crate::value::Value::Number($number) => Some($Name::$Case),)*
                    _ => None,
                }
            }
        }
    };
}

pub(crate) use stored_enum;
