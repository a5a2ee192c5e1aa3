#include "source_files.hpp"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include <busbar/core/status_codes.hpp>

#include "received_program.hpp"

namespace busbar::product {

Configured<SourceFiles::Text> SourceFiles::text(const std::string& path, std::size_t most)
{
    if (const auto known = texts_.find(path); known != texts_.end()) {
        return known->second;
    }
    if (std::error_code ignored; std::filesystem::is_directory(path, ignored)) {
        return misconfigured(path, "found a directory, expected a file");
    }
    errno = 0;
    std::ifstream file{path, std::ios::binary};
    std::string text;
    while (file && text.size() <= most) {
        constexpr std::size_t piece = 64U << 10U;
        const std::size_t before = text.size();
        text.resize(before + piece);
        file.read(text.data() + before, static_cast<std::streamsize>(piece));
        text.resize(before + static_cast<std::size_t>(file.gcount()));
    }
    if (file.bad() || !file.is_open()) {
        return misconfigured(path,
                             "the file cannot be read: " + std::generic_category().message(errno),
                             status::Bad_NotFound);
    }
    if (text.size() > most) {
        return misconfigured(path, "found more than " + std::to_string(most) + " bytes",
                             status::Bad_EncodingLimitsExceeded);
    }
    return texts_.emplace(path, std::make_shared<const std::string>(std::move(text))).first->second;
}

Configured<std::optional<SourceFiles::Text>> SourceFiles::received()
{
    std::error_code ignored;
    const bool is_there = !received_place_.empty() &&
                          (texts_.contains(received_place_) ||
                           (!has_all_ && std::filesystem::exists(received_place_, ignored)));
    if (!is_there) {
        return std::optional<Text>{};
    }
    return text(received_place_, ReceivedProgram::max_size).transform([](Text text) {
        return std::optional{std::move(text)};
    });
}

SourceFiles SourceFiles::with_program(const std::optional<std::string>& document,
                                      const std::string& file,
                                      std::shared_ptr<const controller::Program> program) const
{
    SourceFiles all{texts_};
    all.received_place_ = received_place_;
    if (document) {
        all.texts_[received_place_] = std::make_shared<const std::string>(*document);
        all.programs_[received_place_] = std::move(program);
    } else {
        all.texts_.erase(received_place_);
        all.texts_.erase(file);
    }
    return all;
}

} // namespace busbar::product
