// Data of hostile cameras: replies, and streams that are valid except for their cost.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>

namespace hostile {

inline const std::string ok = "HTTP/1.1 200 OK\r\n";
inline const std::string multipart = ok + "Content-Type: multipart/x-mixed-replace; boundary=b\r\n\r\n";

inline std::string part(const std::string& jpeg)
{
    return "--b\r\nContent-Type: image/jpeg\r\nContent-Length: " + std::to_string(jpeg.size()) + "\r\n\r\n" + jpeg
           + "\r\n";
}

/// A field of a request with its end of line; empty if it has none.
inline std::string field(const std::string& request, const std::string& name)
{
    const auto at = request.find(name + ":");
    return at == std::string::npos ? "" : request.substr(at, request.find('\n', at) + 1 - at);
}
inline std::string sequence(const std::string& request) { return field(request, "CSeq"); }
inline std::string transport(const std::string& request) { return field(request, "Transport"); }

/// A reply of RTSP with this status line and these fields.
inline std::string rtsp(const std::string& request, const std::string& status, const std::string& fields = "",
                        const std::string& content = "")
{
    const auto length = content.empty() ? "" : "Content-Length: " + std::to_string(content.size()) + "\r\n";
    return "RTSP/1.0 " + status + "\r\n" + sequence(request) + fields + length + "\r\n" + content;
}

/// A piece of one image, over TCP (RFC 2326, section 10.12; RFC 6184, section 5.8).
inline std::string h264_fragment(unsigned number, std::size_t size)
{
    const auto byte = [](std::size_t value) { return static_cast<char>(value & 255); };
    std::string packet{byte(0x80), byte(96), byte(number >> 8), byte(number), 0, 0, 0, 1, 0, 0, 0, 1};
    packet += {byte(0x7C), byte(number == 0 ? 0x85 : 5)};
    packet.append(size, 'x');
    return std::string{'$', 0, byte(packet.size() >> 8), byte(packet.size())} + packet;
}

/// A whole image of 16x16 grey pixels, over TCP (RFC 2435, section 3.1).
inline std::string small_rtp_jpeg(unsigned number)
{
    std::string packet{static_cast<char>(0x80), static_cast<char>(0x80 | 26), 0, static_cast<char>(number)};
    packet += {0, 0, static_cast<char>(number), 0, 0, 0, 0, 1};             // the time, the source
    packet += {0, 0, 0, 0, 1, 50, 2, 2};                                    // 4:2:0, quality, size in 8 pixels
    packet += {0x28, static_cast<char>(0xA2), static_cast<char>(0x8A), 0};  // six blocks without new data
    return std::string{'$', 0, 0, static_cast<char>(packet.size())} + packet;
}

/// A section of MPEG-2 systems in one packet of a transport stream (ISO 13818-1, sections 2.4.3 and 2.4.4).
inline std::string transport_packet(unsigned pid, unsigned table, const std::string& contents)
{
    std::string section{static_cast<char>(table), static_cast<char>(0xB0), static_cast<char>(contents.size() + 9)};
    section += std::string("\0\1\xC1\0\0", 5) + contents;
    std::uint32_t crc = 0xFFFFFFFF;
    for (const unsigned char byte : section)
        for (unsigned bit = 0; bit < 8; ++bit)
            crc = (crc << 1) ^ (((crc >> 31) ^ (byte >> (7 - bit) & 1U)) != 0 ? 0x04C11DB7 : 0);
    for (int shift = 24; shift >= 0; shift -= 8)
        section += static_cast<char>(crc >> shift);
    std::string packet{'G', static_cast<char>(0x40 | pid >> 8), static_cast<char>(pid), 0x10, 0};
    packet += section;
    packet.resize(188, static_cast<char>(0xFF));
    return packet;
}

/// The tables of one program with this many H.264 streams, repeated.
inline std::string transport_stream(unsigned streams)
{
    std::string map("\xE1\0\xF0\0", 4), tables;
    for (unsigned i = 0; i < streams; ++i)
        map += std::string{0x1B, static_cast<char>(0xE2), static_cast<char>(i), static_cast<char>(0xF0), 0};
    for (int i = 0; i < 20; ++i)
        tables += transport_packet(0, 0, std::string("\0\1\xE1\0", 4)) + transport_packet(0x100, 2, map);
    return tables;
}

/// A valid grey JPEG of one colour, which takes two bits for 64 pixels. More scans repeat it.
inline std::string grey_jpeg(unsigned width, unsigned height, int scans = 1)
{
    const auto bytes = [](std::initializer_list<unsigned> values) {
        std::string text;
        for (const unsigned value : values)
            text += static_cast<char>(value);
        return text;
    };
    const auto table = [&](unsigned kind) {
        return bytes({0xFF, 0xC4, 0, 20, kind, 1}) + std::string(15, '\0') + std::string(1, '\0');
    };
    const std::size_t blocks = std::size_t{(width + 7) / 8} * ((height + 7) / 8);
    std::string jpeg = bytes({0xFF, 0xD8, 0xFF, 0xDB, 0, 67, 0}) + std::string(64, '\1');
    jpeg += bytes({0xFF, 0xC0, 0, 11, 8, height >> 8, height & 255, width >> 8, width & 255, 1, 1, 0x11, 0});
    jpeg += table(0) + table(16);
    for (int scan = 0; scan < scans; ++scan)
        jpeg += bytes({0xFF, 0xDA, 0, 8, 1, 1, 0, 0, 63, 0}) + std::string((blocks * 2 + 7) / 8, '\0');
    return jpeg + bytes({0xFF, 0xD9});
}

}  // namespace hostile
