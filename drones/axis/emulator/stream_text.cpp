// Writes boundaries and the headers of parts.
#include "stream_text.hpp"

namespace axis::emulator {
namespace {

std::string length_field(const std::string& variant, std::size_t size)
{
    if (variant == "missing")
        return "";
    const std::string value = variant == "short"  ? std::to_string(size / 2)
                              : variant == "long" ? std::to_string(size + 500)
                              : variant == "text" ? "many"
                              : variant == "huge" ? "99999999999"
                                                  : std::to_string(size);
    return "Content-Length: " + value;
}

}  // namespace

std::string stream_type(const Behaviour& behaviour)
{
    const std::string& boundary = behaviour.boundary;
    return std::string("multipart/x-mixed-replace;") + (boundary == "tight" ? "" : " ") + "boundary="
           + (boundary == "dashed"   ? "--myboundary"
              : boundary == "quoted" ? "\"myboundary\""
                                     : "myboundary");
}

std::string stream_part(const Behaviour& behaviour, const std::string& jpeg)
{
    const std::string end = behaviour.line_end == "lf" ? "\n" : "\r\n";
    const std::string body = behaviour.truncated ? jpeg.substr(0, jpeg.size() / 2) : jpeg;
    std::string text = "--myboundary" + end;
    if (behaviour.garbage)
        text += "X-Unknown: \xE4\x01\xFF" + end;
    text += "Content-Type: image/jpeg" + end;
    if (const auto length = length_field(behaviour.length, body.size()); !length.empty())
        text += length + end;
    text += end + body + end;
    if (behaviour.garbage)
        text += "\xFF\xD8 this is no picture \xFF\xD9 -- --my" + end;
    return text;
}

}  // namespace axis::emulator
