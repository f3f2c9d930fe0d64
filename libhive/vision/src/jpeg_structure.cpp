// Walks the markers of a JPEG, and checks every length against the available bytes.
#include "jpeg_structure.hpp"

#include "exif.hpp"
#include "scan_coverage.hpp"

#include <hive/error.hpp>

#include <cstring>
#include <string>

namespace hive::vision {
namespace {

using Bytes = std::span<const std::uint8_t>;

enum Marker : std::uint8_t {
    first_sof = 0xC0,
    last_sof = 0xCF,
    dht = 0xC4,
    jpg = 0xC8,
    dac = 0xCC,
    first_restart = 0xD0,
    last_restart = 0xD7,
    soi = 0xD8,
    eoi = 0xD9,
    sos = 0xDA,
    app1 = 0xE1,
    stuffed = 0x00,
    temporary = 0x01
};

[[noreturn]] void malformed(const std::string& text) { throw Error(Errc::malformed, "JPEG: " + text); }

bool is_frame(std::uint8_t marker)
{
    return marker >= first_sof && marker <= last_sof && marker != dht && marker != jpg && marker != dac;
}

bool stands_alone(std::uint8_t marker)
{
    return (marker >= first_restart && marker <= last_restart) || marker == temporary;
}

class Walk {
public:
    Walk(Bytes bytes, int max_scans) : bytes_(bytes), max_scans_(max_scans) {}

    JpegStructure run()
    {
        if (bytes_.size() < 4 || bytes_[0] != 0xFF || bytes_[1] != soi)
            malformed("does not start with a start-of-image marker");
        position_ = 2;
        while (segment(marker())) {
        }
        if (found_.scans == 0)
            malformed("has no scan");
        for (std::size_t i = 0; i < components_.size() / 3; ++i)
            if (!coverage_.complete(components_[3 * i]))
                malformed("ends before its last scan");
        found_.size = position_;
        return found_;
    }

private:
    /// The next marker; any number of FF may fill the space before its code.
    std::uint8_t marker()
    {
        if (position_ >= bytes_.size())
            malformed("ends before its end-of-image marker");
        if (bytes_[position_] != 0xFF)
            malformed("a marker is missing at byte " + std::to_string(position_));
        while (position_ < bytes_.size() && bytes_[position_] == 0xFF)
            ++position_;
        if (position_ >= bytes_.size())
            malformed("ends before its end-of-image marker");
        return bytes_[position_++];
    }

    /// The contents of a segment with a length; continues after it.
    Bytes contents()
    {
        if (bytes_.size() - position_ < 2)
            malformed("ends inside a segment");
        const std::size_t length = std::size_t{bytes_[position_]} << 8 | bytes_[position_ + 1];
        if (length < 2 || length > bytes_.size() - position_)
            malformed("ends inside a segment");
        const Bytes inside = bytes_.subspan(position_ + 2, length - 2);
        position_ += length;
        return inside;
    }

    /// Processes one segment; false at the end of the image.
    bool segment(std::uint8_t marker)
    {
        if (marker == eoi)
            return false;
        if (marker == soi || marker == stuffed)
            malformed("a marker in an invalid place");
        if (stands_alone(marker))
            return true;
        const Bytes inside = contents();
        if (is_frame(marker))
            frame(marker, inside);
        else if (marker == app1 && found_.orientation == 1)
            found_.orientation = exif_orientation(inside);
        else if (marker == sos)
            scan(inside);
        return true;
    }

    void frame(std::uint8_t marker, Bytes inside)
    {
        if (found_.width != 0)
            malformed("has more than one frame");
        if (inside.size() < 6)
            malformed("its frame header is too short");
        if (marker > 0xC2)
            throw Error(Errc::unsupported,
                        "JPEG: only baseline, extended and progressive Huffman coding are supported");
        if (inside[0] != 8 || (inside[5] != 1 && inside[5] != 3 && inside[5] != 4))
            throw Error(Errc::unsupported, "JPEG: only 8 bit grey, colour and CMYK images are supported");
        found_.height = inside[1] << 8 | inside[2];
        found_.width = inside[3] << 8 | inside[4];
        found_.components = inside[5];
        if (found_.width == 0 || found_.height == 0)
            malformed("has no width or no height");
        components_ = inside.subspan(6);
        if (components_.size() != std::size_t{3} * inside[5])
            malformed("its frame header has the wrong length");
        progressive_ = marker == 0xC2;
    }

    /// Skips the coded data of a scan: up to the next FF that is neither data (FF 00) nor a restart.
    void scan(Bytes header)
    {
        if (found_.width == 0)
            malformed("a scan comes before the frame header");
        if (++found_.scans > max_scans_)
            throw Error(Errc::too_large, "JPEG: more than " + std::to_string(max_scans_) + " scans");
        if (!coverage_.add(header, progressive_))
            malformed("a scan header makes no sense");
        while (position_ + 1 < bytes_.size()) {
            const void* found = std::memchr(bytes_.data() + position_, 0xFF, bytes_.size() - position_ - 1);
            if (!found)
                break;
            position_ = static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - bytes_.data());
            const std::uint8_t code = bytes_[position_ + 1];
            if (code != stuffed && (code < first_restart || code > last_restart))
                return;
            position_ += 2;
        }
        malformed("ends before its end-of-image marker");
    }

    Bytes bytes_;
    int max_scans_;
    std::size_t position_ = 0;
    JpegStructure found_;
    Bytes components_;  ///< of the frame header: three bytes each, the first is the identifier
    bool progressive_ = false;
    ScanCoverage coverage_;
};

}  // namespace

JpegStructure jpeg_structure(Bytes bytes, int max_scans) { return Walk(bytes, max_scans).run(); }

}  // namespace hive::vision
