// The EXIF of an image: an orientation from 1 to 8, whatever the bytes are. Input: the contents of a segment APP1.
#include "exif.hpp"

#include "require.hpp"

#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    using hive::fuzz::require;
    const std::vector<std::uint8_t> exact(bytes, bytes + size);  // a read beyond it is seen
    std::vector<std::uint8_t> marked{'E', 'x', 'i', 'f', 0, 0};
    marked.insert(marked.end(), bytes, bytes + size);
    for (const auto& segment : {exact, marked}) {
        const int orientation = hive::vision::exif_orientation(segment);
        require(orientation >= 1 && orientation <= 8, "an orientation is one of eight");
    }
    return 0;
}
