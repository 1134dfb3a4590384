//! Encoding and decoding of structs and enums, from a list of their fields.

/// Implements `Write` and `Read` for a struct, field by field. A field that is not in the list does not compile.
macro_rules! codec_struct {
    ($type:ident { $($field:ident),* $(,)? }) => {
        impl<S: $crate::scalar::Scalar> $crate::codec::Write for $type<S> {
            fn write(&self, out: &mut impl $crate::codec::Encoder) {
                let Self { $($field),* } = self;
                $($crate::codec::field(out, stringify!($field), $field);)*
            }
        }

        impl $crate::codec::Read for $type<$crate::fx::Fx> {
            fn read(reader: &mut $crate::codec::Reader<'_>) -> Result<Self, $crate::codec::Malformed> {
                Ok(Self { $($field: $crate::codec::Read::read(reader)?),* })
            }
        }
    };
}

/// Does the same for a struct that has no scalar.
macro_rules! codec_plain {
    ($type:ident { $($field:ident),* $(,)? }) => {
        impl $crate::codec::Write for $type {
            fn write(&self, out: &mut impl $crate::codec::Encoder) {
                let Self { $($field),* } = self;
                $($crate::codec::field(out, stringify!($field), $field);)*
            }
        }

        impl $crate::codec::Read for $type {
            fn read(reader: &mut $crate::codec::Reader<'_>) -> Result<Self, $crate::codec::Malformed> {
                Ok(Self { $($field: $crate::codec::Read::read(reader)?),* })
            }
        }
    };
}

/// Implements `Write` and `Read` for an enum: a byte for the variant, then its fields. A variant that is not in the list does
/// not compile. The number of a variant never changes.
macro_rules! codec_enum {
    ($type:ident $(<$s:ident>)?, $expected:literal, {
        $($tag:literal => $variant:ident $({ $($field:ident),* })? $(( $($entry:ident),* ))?),* $(,)?
    }) => {
        impl $(<$s: $crate::scalar::Scalar>)? $crate::codec::Write for $type $(<$s>)? {
            fn write(&self, out: &mut impl $crate::codec::Encoder) {
                match self {
                    $(Self::$variant $({ $($field),* })? $(( $($entry),* ))? => {
                        out.leaf(&[$tag], &stringify!($variant));
                        $($($crate::codec::field(out, stringify!($field), $field);)*)?
                        $($($crate::codec::field(out, stringify!($entry), $entry);)*)?
                    })*
                }
            }
        }

        codec_enum!(@read $type $(<$s>)?, $expected, {
            $($tag => $variant $({ $($field),* })? $(( $($entry),* ))?),*
        });
    };
    (@read $type:ident <$s:ident>, $expected:literal, $variants:tt) => {
        codec_enum!(@from [$type<$crate::fx::Fx>], $expected, $variants);
    };
    (@read $type:ident, $expected:literal, $variants:tt) => {
        codec_enum!(@from [$type], $expected, $variants);
    };
    (@from [$type:ty], $expected:literal, {
        $($tag:literal => $variant:ident $({ $($field:ident),* })? $(( $($entry:ident),* ))?),* $(,)?
    }) => {
        impl $crate::codec::Read for $type {
            fn read(reader: &mut $crate::codec::Reader<'_>) -> Result<Self, $crate::codec::Malformed> {
                let malformed = reader.malformed($expected);
                match <u8 as $crate::codec::Read>::read(reader)? {
                    $($tag => {
                        $($(let $field = $crate::codec::Read::read(reader)?;)*)?
                        $($(let $entry = $crate::codec::Read::read(reader)?;)*)?
                        Ok(Self::$variant $({ $($field),* })? $(( $($entry),* ))?)
                    })*
                    _ => Err(malformed),
                }
            }
        }
    };
}

pub(crate) use {codec_enum, codec_plain, codec_struct};
