// The behaviour and faults of the emulated camera: settings name=value, from the command line or at run time.
#pragma once

#include "login.hpp"

#include <map>
#include <string>

namespace axis::emulator {

struct Behaviour {
    // what it is
    int fps = 25;               ///< when its parameter Stream.FPS is 0
    int step = 1;               ///< sensor values are rounded down to multiples of it
    std::string auth = "none";  ///< none, basic, digest, basic_digest
    bool qop = true;
    int nonce_uses = 0;              ///< 0: a nonce is never stale
    bool old_firmware = false;       ///< accepts updates only at /axis-cgi/admin/param.cgi
    std::string boundary = "plain";  ///< plain, dashed, quoted, tight
    std::string length = "right";    ///< right, missing, short, long, text, huge
    std::string line_end = "crlf";   ///< crlf, lf

    // faults
    bool down = false;          ///< no listener, all connections end
    bool mute = false;          ///< accepts connections and sends nothing
    bool stall = false;         ///< streams pause
    bool unauthorised = false;  ///< every login is refused
    bool html = false;          ///< a web page instead of images
    bool foreign = false;       ///< a web server that is not a camera
    bool garbage = false;       ///< bytes between the parts, unknown fields in their heads
    bool truncated = false;     ///< half images in complete parts
    bool endless_head = false, endless_part = false;
    bool huge_head = false;                                  ///< 100 KiB of fields before every answer
    int status = 200;                                        ///< of the images
    int stall_after = -1, close_after = -1, cut_after = -1;  ///< images of a stream; -1: never
    int bytes_per_s = 0;                                     ///< 0: unlimited
    std::string redirect;                                    ///< target of all redirections

    /// @throws std::invalid_argument  naming the valid ones
    void set(const std::string& name, const std::string& value);
    /// One line per setting.
    [[nodiscard]] std::string text() const;
    [[nodiscard]] LoginRules login() const;
};

}  // namespace axis::emulator
