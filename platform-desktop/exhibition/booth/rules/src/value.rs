//! Values of database columns, and the field types that are stored as them.

use paros_core::session::SessionMode;

/// A value of a column.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Value {
    /// NULL.
    Null,
    /// An integer. A `u64` is stored as an `i64` with the same bits.
    Number(i64),
    /// Bytes.
    Bytes(Vec<u8>),
    /// Text in UTF-8.
    Text(String),
}

/// A type that can be a parameter of a statement.
pub trait ToValue {
    /// Returns the value that is stored.
    fn to_value(&self) -> Value;
}

/// A type of a record's field.
pub trait Field: ToValue + Sized {
    /// Reads a stored value; `None` if the value isn't of this type.
    fn from_value(value: Value) -> Option<Self>;
}

/// Makes a type a [`Field`]: `field!(TYPE as CASE, this => STORED, stored => READ)`.
macro_rules! field {
    ($Type:ty as $Case:ident, $this:ident => $to:expr, $stored:ident => $from:expr) => {
        impl $crate::value::ToValue for $Type {
            fn to_value(&self) -> $crate::value::Value {
                let $this = self;
                $crate::value::Value::$Case($to)
            }
        }

        impl $crate::value::Field for $Type {
            fn from_value(value: $crate::value::Value) -> Option<Self> {
                match value {
                    $crate::value::Value::$Case($stored) => $from,
                    _ => None,
                }
            }
        }
    };
}

field!(u8 as Number, this => i64::from(*this), number => number.try_into().ok());
field!(u16 as Number, this => i64::from(*this), number => number.try_into().ok());
field!(u32 as Number, this => i64::from(*this), number => number.try_into().ok());
field!(u64 as Number, this => this.cast_signed(), number => Some(number.cast_unsigned()));
field!(bool as Number, this => i64::from(*this), number => [false, true].get(usize::try_from(number).ok()?).copied());
field!(String as Text, this => this.clone(), text => Some(text));
field!(Vec<u8> as Bytes, this => this.clone(), bytes => Some(bytes));

field!(SessionMode as Number,
mode => match mode {
    SessionMode::None => 0,
    SessionMode::FreeForm => 1,
    SessionMode::Creative => 2,
    SessionMode::Own => 3,
    SessionMode::Constrained { figure } => FIRST_FIGURE + i64::from(*figure),
},
number => match number {
    0 => Some(SessionMode::None),
    1 => Some(SessionMode::FreeForm),
    2 => Some(SessionMode::Creative),
    3 => Some(SessionMode::Own),
    number => u8::try_from(number.checked_sub(FIRST_FIGURE)?)
        .ok()
        .map(|figure| SessionMode::Constrained { figure }),
});

/// The stored number of figure 0. A session that starts from a hidden figure is stored as this plus the
/// figure's number.
const FIRST_FIGURE: i64 = 256;

impl<const N: usize> ToValue for [u8; N] {
    fn to_value(&self) -> Value {
        Value::Bytes(self.to_vec())
    }
}

impl<const N: usize> Field for [u8; N] {
    fn from_value(value: Value) -> Option<Self> {
        Vec::from_value(value)?.try_into().ok()
    }
}

impl<T: ToValue> ToValue for Option<T> {
    fn to_value(&self) -> Value {
        self.as_ref().map_or(Value::Null, ToValue::to_value)
    }
}

impl<T: Field> Field for Option<T> {
    fn from_value(value: Value) -> Option<Self> {
        match value {
            Value::Null => Some(None),
            value => T::from_value(value).map(Some),
        }
    }
}

impl ToValue for Value {
    fn to_value(&self) -> Value {
        self.clone()
    }
}

impl ToValue for &str {
    fn to_value(&self) -> Value {
        Value::Text((*self).to_owned())
    }
}

impl ToValue for &[u8] {
    fn to_value(&self) -> Value {
        Value::Bytes(self.to_vec())
    }
}

/// A `LIMIT` of rows.
impl ToValue for usize {
    fn to_value(&self) -> Value {
        Value::Number(i64::try_from(*self).unwrap_or(i64::MAX))
    }
}

/// An enum without fields that is stored as its number. The numbers never change.
macro_rules! stored_enum {
    (
        $(#[$about:meta])*
        pub enum $Name:ident { $($(#[$about_case:meta])* $Case:ident = $number:literal,)* }
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, PartialEq, Eq, Debug)]
        #[repr(u8)]
        pub enum $Name { $($(#[$about_case])* $Case = $number,)* }

        $crate::value::field!($Name as Number, this => *this as i64, number => match number {
            $($number => Some($Name::$Case),)*
            _ => None,
        });
    };
}

pub(crate) use {field, stored_enum};
