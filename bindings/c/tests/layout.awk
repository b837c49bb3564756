# The numbers of tests/layout.rs, for the C compiler to check: awk -f layout.awk layout.rs > layout.c
BEGIN {
    print "#include \"backstop.h\""
    print "#define SIZE(type, size) _Static_assert(sizeof(type) == size, #type)"
    print "#define FIELD(type, field, at) _Static_assert(offsetof(type, field) == at, #type \".\" #field)"
}
/^    pinned!\(/ {
    split($0, of, /[(,] */)
    name = of[2]
    printf "SIZE(%s, %s);\n", name, of[3]
    next
}
/^    \]\);/ { name = "" }
name != "" {
    count = split($0, fields, /, */)
    for (i = 1; i <= count; i++)
        if (split(fields[i], field, " ") == 2) printf "FIELD(%s, %s, %s);\n", name, field[1], field[2]
}
