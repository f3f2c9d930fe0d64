// Continues from the number at the end of the name.
#include "next_free.hpp"

namespace next_free {

namespace fs = std::filesystem;

std::string after(const fs::path& folder, const fs::path& file)
{
    const bool is_folder = !file.has_filename();
    const auto name = is_folder ? file.parent_path() : file;
    auto stem = name.stem().string();
    int number = 2;
    const auto dash = stem.rfind('-');
    const auto digits = dash == std::string::npos ? std::string() : stem.substr(dash + 1);
    if (!digits.empty() && digits.size() < 6 && digits.find_first_not_of("0123456789") == std::string::npos) {
        number = std::stoi(digits) + 1;
        stem.resize(dash);
    }
    std::error_code ignored;
    fs::path next;
    do
        next = name.parent_path() / (stem + "-" + std::to_string(number++) + name.extension().string());
    while (fs::exists(folder / next, ignored));
    return next.string() + (is_folder ? "/" : "");
}

}  // namespace next_free
