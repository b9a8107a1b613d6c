//! Trait objects that are plain values: they can be copied, saved and restored.

/// Defines the trait `$object` with the methods of a boxed `$interface`, and implements it for
/// every plain value.
macro_rules! saved_object {
    ($(#[$documentation:meta])* $object:ident for $interface:ident) => {
        $(#[$documentation])*
        pub trait $object {
            /// A copy in the same state.
            fn boxed(&self) -> Box<dyn $interface>;
            /// State for a checkpoint.
            fn save(&self) -> Vec<u8>;
            /// Takes over a state.
            ///
            /// # Errors
            /// Bytes that do not decode.
            fn restore(&mut self, state: &[u8]) -> Result<(), String>;
            /// The value itself, for downcasting to its type.
            fn as_any(&self) -> &dyn Any;
        }

        impl<T> $object for T
        where
            T: $interface + Clone + Serialize + DeserializeOwned + 'static,
        {
            fn boxed(&self) -> Box<dyn $interface> {
                Box::new(self.clone())
            }

            fn save(&self) -> Vec<u8> {
                postcard::to_stdvec(self).expect("plain data can be encoded")
            }

            fn restore(&mut self, state: &[u8]) -> Result<(), String> {
                *self = postcard::from_bytes(state).map_err(|error| error.to_string())?;
                Ok(())
            }

            fn as_any(&self) -> &dyn Any {
                self
            }
        }

        impl Clone for Box<dyn $interface> {
            fn clone(&self) -> Self {
                (**self).boxed()
            }
        }
    };
}
pub(super) use saved_object;
