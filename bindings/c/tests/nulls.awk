# Reads include/backstop.h and writes a program in C that calls every function with null for each pointer
# and zero for all else: it is refused with words, or does nothing. Then those of a world with a world:
# whatever is refused has words, and nothing has changed.
/^ *\/\// || /^ *#/ { next }
/BS_API/ { declaration = ""; inside = 1 }
inside { declaration = declaration " " $0 }
inside && /;/ {
    inside = 0
    gsub(/ +/, " ", declaration)
    sub(/^ ?BS_API /, "", declaration)
    if (!match(declaration, /bs_[a-z0-9_]+\(/)) next
    name = substr(declaration, RSTART, RLENGTH - 1)
    result = substr(declaration, 1, RSTART - 1)
    list = substr(declaration, RSTART + RLENGTH)
    sub(/\).*/, "", list)
    count = split(list, parameters, /, */)
    call = alive = ""
    for (i = 1; i <= count; i++) {
        type = parameters[i]
        if (type == "void") continue
        sub(/[a-z_0-9]+ *$/, "", type)
        value = type ~ /\*/ ? "NULL" : "(" type "){0}"
        call = call (i == 1 ? "" : ", ") value
        alive = alive (i == 1 ? "" : ", ") (type ~ /BsWorld \*$/ ? "world" : value)
    }
    if (alive != call && result ~ /^BsStatus $/) {
        changes = changes "    keep(\"" name "\", " name "(" alive "));\n"
    }
    call = name "(" call ")"
    if (result ~ /^BsStatus $/) body = body "    refuse(\"" name "\", " call ");\n"
    else if (result ~ /^void $/) body = body "    " call ";\n"
    else if (result ~ /^BsBool $/) body = body "    deny(\"" name "\", " call ");\n"
}
END {
    print "#include \"backstop.h\"\n#include <stdio.h>\n#include <string.h>\n"
    print "static int failures, calls;\nstatic BsWorld *world;\nstatic uint64_t before;\n"
    print "static void check(const char *name, int well) {"
    print "    calls++;\n    if (well) return;\n    failures++;"
    print "    printf(\"%s: %s\\n\", name, bs_last_error());\n}\n"
    print "static void refuse(const char *name, BsStatus status) {"
    print "    check(name, status == BS_ERROR_NULL && strlen(bs_last_error()) > 0);\n}\n"
    print "static void deny(const char *name, BsBool yes) {\n    check(name, !yes);\n}\n"
    print "static void keep(const char *name, BsStatus status) {"
    print "    uint64_t after = 0;"
    print "    check(name, (status == BS_OK) == (strlen(bs_last_error()) == 0));"
    print "    check(name, bs_world_state_hash(world, &after) == BS_OK && after == before);\n}\n"
    print "int main(void) {\n" body
    print "    BsShapeDesc shape = bs_shape_desc_default(bs_sphere(0.5f));"
    print "    BsBodyDesc desc = bs_body_desc_default();"
    print "    BsBody body;\n    desc.shapes = &shape;\n    desc.shape_count = 1;"
    print "    if (bs_world_create(NULL, &world) || bs_world_add_body(world, &desc, &body)) return 1;"
    print "    if (bs_world_step(world, 0.01f) || bs_world_state_hash(world, &before)) return 1;\n"
    print changes
    print "    bs_world_destroy(world);"
    print "    printf(\"%d checks of nulls, %d failed\\n\", calls, failures);"
    print "    return failures != 0 || calls < 500;\n}"
}
