// There are no announcements.
#include <hive/discovery/announcer.hpp>
#include <hive/discovery/browser.hpp>
#include <hive/transport/key_ring.hpp>

namespace hive::discovery {

class DaemonThread {};
class Announcer::Work {};
Announcer::Announcer(Plan) {}
Announcer::~Announcer() = default;

class Browser::Work {};
Browser::Browser(std::filesystem::path, std::filesystem::path) {}
Browser::~Browser() = default;
std::vector<Neighbour> Browser::found() { return {}; }

}  // namespace hive::discovery
