//! Code that is compiled once for each type of lanes, and the choice among them.

/// Work that is compiled once for each type of lanes. All that it does in lanes has to be inlined into
/// [`Kernel::run`], or be a kernel itself: elsewhere each operation would be a call.
pub(crate) trait Kernel {
    type Output;
    /// Implementations are `#[inline(always)]`.
    fn run(self) -> Self::Output;
}

/// A function whose body is a [`Kernel`]: not inlined where it is called, and compiled for the instructions
/// of its lanes. Its references have one lifetime, or two. A last parameter may be of another type, after a
/// semicolon.
macro_rules! kernel {
    (@output) => { () };
    (@output $output:ty) => { $output };
    ($(#[$attribute:meta])* $vis:vis unsafe fn $($rest:tt)*) => {
        $crate::lanes::kernel!(@ [$(#[$attribute])* $vis unsafe fn] $($rest)*);
    };
    ($(#[$attribute:meta])* $vis:vis fn $($rest:tt)*) => {
        $crate::lanes::kernel!(@ [$(#[$attribute])* $vis fn] $($rest)*);
    };
    (@ [$($head:tt)*] $name:ident<
        $a:lifetime $(, $b:lifetime)?, $L:ident: $lanes:path
        $(, const $N:ident: $kind:ty)* $(; $R:ident: $bound:path)?
    >($($argument:ident: $of:ty),* $(,)?) $(-> $output:ty)? $body:block) => {
        #[inline(always)]
        $($head)* $name<$a $(, $b)?, $L: $lanes $(, $R: $bound)? $(, const $N: $kind)*>(
            $($argument: $of),*
        ) $(-> $output)? {
            struct Work<$a $(, $b)?, $L: $lanes $(, $R: $bound)? $(, const $N: $kind)*> {
                $($argument: $of,)*
                types: std::marker::PhantomData<(&$a $L, $($R)?)>,
            }
            impl<$a $(, $b)?, $L: $lanes $(, $R: $bound)? $(, const $N: $kind)*> $crate::lanes::Kernel
                for Work<$a $(, $b)?, $L $(, $R)? $(, $N)*>
            {
                type Output = $crate::lanes::kernel!(@output $($output)?);
                #[inline(always)]
                fn run(self) -> Self::Output {
                    let Work { $($argument,)* types: _ } = self;
                    $body
                }
            }
            let work = Work::<$L $(, $R)? $(, $N)*> { $($argument,)* types: std::marker::PhantomData };
            <$L as $crate::lanes::Lanes>::run(work)
        }
    };
}
pub(crate) use kernel;

/// Calls `$body` with `$Wide` as the type of eight lanes that suits the processor. `$body` enters kernels by
/// [`Lanes::run`].
#[cfg(all(target_arch = "x86_64", not(target_feature = "avx2"), not(backstop_baseline)))]
macro_rules! with_best {
    ($Wide:ident => $body:expr) => {
        if $crate::lanes::has_avx2() {
            type $Wide = $crate::lanes::Avx8;
            $body
        } else {
            type $Wide = $crate::lanes::f32x8;
            $body
        }
    };
}
/// Calls `$body` with `$Wide` as the type of eight lanes of the target.
#[cfg(not(all(target_arch = "x86_64", not(target_feature = "avx2"), not(backstop_baseline))))]
macro_rules! with_best {
    ($Wide:ident => $body:expr) => {{
        type $Wide = $crate::lanes::f32x8;
        $body
    }};
}
pub(crate) use with_best;
