# SPDX-License-Identifier: GPL-3.0-or-later
# Hardening as Debian asks of programs that read files from outside: a canary before each return address, lengths that the compiler
# knows checked at run time, and tables of addresses that are read-only once the program runs. Release builds only:
# sanitizers have their own, and FORTIFY needs an optimizing compiler.
set(OPTIMIZED $<CONFIG:Release,RelWithDebInfo,MinSizeRel>)
# -U: a packager's flags may define it, and with another value.
add_compile_options(-fstack-protector-strong "$<${OPTIMIZED}:-U_FORTIFY_SOURCE>" "$<${OPTIMIZED}:-D_FORTIFY_SOURCE=3>")
add_link_options(-Wl,-z,relro -Wl,-z,now -Wl,-z,noexecstack)
