// Reads a .nvv with the library neuvv_voctree alone, which must not need what clips from servers need.
#include <cstdio>

#include "voctree/files/nvv.h"

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    const neuvv::voctree::VOctree tree = neuvv::voctree::read_nvv(argv[1]);
    std::printf("%u leaves\n", tree.leaf_count);
    return tree.leaf_count > 0 ? 0 : 1;
}
