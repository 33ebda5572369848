#include <rubato/core/version.hpp>

#include <cstdio>

int main() { std::printf("rubato %s\n", rubato::version); }
