#include "source_files.hpp"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include <busbar/controller/program_files.hpp>
#include <busbar/core/status_codes.hpp>

#include "received_program.hpp"

namespace busbar::product {

namespace {

Configured<std::string> read_file(const std::string& path, std::size_t most)
{
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
    return text;
}

} // namespace

Configured<SourceFiles::Text> SourceFiles::text(const std::string& path, std::size_t most)
{
    if (const auto known = texts_.find(path); known != texts_.end()) {
        return known->second;
    }
    return read_file(path, most).transform([&](std::string text) {
        return remember(path, std::move(text));
    });
}

Configured<SourceFiles::Text> SourceFiles::program_text(const std::string& path, std::size_t most)
{
    if (const auto known = texts_.find(path); known != texts_.end()) {
        return known->second;
    }
    return controller::read_program_files(path, most).transform([&](std::string text) {
        return remember(path, std::move(text));
    });
}

SourceFiles::Text SourceFiles::remember(const std::string& path, std::string text)
{
    const auto before = texts_before_.find(path);
    if (before != texts_before_.end() && *before->second == text) {
        return texts_.emplace(path, before->second).first->second;
    }
    programs_.erase(path);
    labels_.erase(path);
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
                                      const std::string& file, Prepared prepared) const
{
    SourceFiles all{*this};
    all.has_all_ = !all.texts_.empty();
    all.texts_.erase(received_place_);
    all.programs_.erase(received_place_);
    const std::string& place = document ? received_place_ : file;
    if (document) {
        all.texts_[place] = std::make_shared<const std::string>(*document);
    } else {
        all.texts_.erase(file);
        if (prepared.text != nullptr) {
            all.texts_[place] = std::move(prepared.text);
        }
    }
    if (prepared.program != nullptr) {
        all.programs_[place] = std::move(prepared.program);
    } else {
        all.programs_.erase(place);
    }
    if (prepared.tried != nullptr) {
        all.tried_ = std::move(prepared.tried);
    }
    return all;
}

SourceFiles SourceFiles::again() const
{
    SourceFiles all;
    all.received_place_ = received_place_;
    all.texts_before_ = texts_;
    all.programs_ = programs_;
    all.labels_ = labels_;
    all.tried_ = tried_;
    return all;
}

SourceFiles SourceFiles::again_with(const std::string& file, Prepared prepared) const
{
    SourceFiles all = again();
    all.texts_before_[file] = std::move(prepared.text);
    if (prepared.labels != nullptr) {
        all.labels_[file] = std::move(prepared.labels);
    } else {
        all.programs_[file] = std::move(prepared.program);
    }
    if (prepared.tried != nullptr) {
        all.tried_ = std::move(prepared.tried);
    }
    return all;
}

} // namespace busbar::product
