#include "taken_over.hpp"

#include <array>
#include <charconv>
#include <span>
#include <utility>

#include "controller/life/checksum.hpp"

namespace busbar::product {

namespace {

constexpr std::size_t max_part_size = 256U << 20U;
constexpr std::string_view files_name = "files";
constexpr std::string_view settings_name = "settings";
constexpr std::string_view project_name = "project";
constexpr std::string_view listeners_name = "listeners";

std::span<const std::byte> bytes_of(std::string_view text)
{
    return std::as_bytes(std::span{text});
}

/// Takes the text up to the next `end`, and that too; nothing if there is none.
std::optional<std::string_view> take_until(std::string_view& rest, char end)
{
    const std::size_t at = rest.find(end);
    if (at == std::string_view::npos) {
        return std::nullopt;
    }
    const std::string_view taken = rest.substr(0, at);
    rest.remove_prefix(at + 1);
    return taken;
}

template <typename T>
std::optional<T> number_in(std::optional<std::string_view> text)
{
    T number{};
    if (!text) {
        return std::nullopt;
    }
    const char* const end = text->data() + text->size();
    const auto read = std::from_chars(text->data(), end, number);
    return read.ec == std::errc{} && read.ptr == end ? std::optional{number} : std::nullopt;
}

/// Writes each file as "SIZE-OF-PATH SIZE-OF-TEXT PATH" followed by its text.
std::string text_of(const SourceFiles::Texts& files)
{
    std::string all;
    for (const auto& [path, text] : files) {
        all += std::to_string(path.size()) + " " + std::to_string(text->size()) + " " + path;
        all += *text;
    }
    return all;
}

std::optional<SourceFiles::Texts> files_in(std::string_view all)
{
    SourceFiles::Texts files;
    while (!all.empty()) {
        const auto path = number_in<std::size_t>(take_until(all, ' '));
        const auto text = number_in<std::size_t>(take_until(all, ' '));
        if (!path || !text || *path > all.size() || *text > all.size() - *path) {
            return std::nullopt;
        }
        files.emplace(all.substr(0, *path),
                      std::make_shared<const std::string>(all.substr(*path, *text)));
        all.remove_prefix(*path + *text);
    }
    return files;
}

/// Writes "USE PORT ADDRESS", a line each.
std::string text_of(const std::vector<FurtherListener>& listeners)
{
    std::string all;
    for (const auto& each : listeners) {
        all += std::to_string(static_cast<unsigned>(each.use)) + " " + std::to_string(each.port) +
               " " + each.address + "\n";
    }
    return all;
}

std::optional<std::vector<FurtherListener>> listeners_in(std::string_view all)
{
    constexpr auto last_use = static_cast<unsigned>(controller::ListenerUse::Administration);
    std::vector<FurtherListener> listeners;
    while (!all.empty()) {
        const auto use = number_in<unsigned>(take_until(all, ' '));
        const auto port = number_in<std::uint16_t>(take_until(all, ' '));
        const auto address = take_until(all, '\n');
        if (!use || *use > last_use || !port || !address) {
            return std::nullopt;
        }
        listeners.push_back(
            {std::string{*address}, *port, static_cast<controller::ListenerUse>(*use)});
    }
    return listeners;
}

} // namespace

Configured<void> TakenOverFiles::keep_part(std::string_view name, std::string_view text)
{
    std::string sum = controller::detail::checksum_text(text);
    if (const auto known = known_.find(name); known != known_.end() && known->second == sum) {
        return {};
    }
    std::string file;
    file.reserve(sum.size() + 1 + text.size());
    file.append(sum).append("\n").append(text);
    const std::string path = storage_path(folder, name);
    if (const auto made = storage_->make_folder(folder, FileAccess::Owner); !made) {
        return misconfigured(storage_->place(folder), std::string{busbar::text(made.error())},
                             status_of(made.error()));
    }
    if (const auto kept = storage_->replace(path, bytes_of(file), FileAccess::Owner); !kept) {
        return misconfigured(storage_->place(path), std::string{busbar::text(kept.error())},
                             status_of(kept.error()));
    }
    known_.insert_or_assign(std::string{name}, std::move(sum));
    return {};
}

Configured<void> TakenOverFiles::keep(const TakenOver& all)
{
    Configured<void> done;
    const auto keep_one = [&](std::string_view name, std::string_view text) {
        auto kept = keep_part(name, text);
        const bool is_kept = kept.has_value();
        if (!is_kept && done) {
            done = std::move(kept);
        }
        return is_kept;
    };
    keep_one(files_name, text_of(all.files));
    if (all.project == nullptr) {
        keep_one(project_name, {});
        kept_project_.reset();
    } else if (all.project != kept_project_ && keep_one(project_name, *all.project)) {
        kept_project_ = all.project;
    }
    if (all.settings) {
        keep_one(settings_name, *all.settings);
    }
    if (!all.listeners.empty()) {
        keep_one(listeners_name, text_of(all.listeners));
    }
    return done;
}

void TakenOverFiles::forget_settings()
{
    static_cast<void>(storage_->remove(storage_path(folder, settings_name)));
    known_.erase(std::string{settings_name});
}

Configured<void> TakenOverFiles::forget_file(const std::string& path)
{
    auto files = files_in(part(files_name));
    if (!files || files->erase(path) == 0) {
        return {};
    }
    return keep_part(files_name, text_of(*files));
}

Configured<void> TakenOverFiles::keep_copy(std::string_view file)
{
    const auto remove = [&] {
        static_cast<void>(storage_->remove(storage_path(folder, file)));
        known_.erase(std::string{file});
    };
    const auto bytes = read_file(*storage_, file, max_part_size);
    // At a first start the folder is not there yet.
    if (!bytes &&
        (bytes.error() == StorageError::NotFound || bytes.error() == StorageError::Away)) {
        remove();
        return {};
    }
    if (!bytes) {
        return misconfigured(storage_->place(file), std::string{busbar::text(bytes.error())},
                             status_of(bytes.error()));
    }
    if (!known_.contains(file)) {
        static_cast<void>(part(file));
    }
    auto kept = keep_part(file, {reinterpret_cast<const char*>(bytes->data()), bytes->size()});
    if (!kept) {
        remove();
    }
    return kept;
}

std::optional<std::string> TakenOverFiles::copy(std::string_view file)
{
    std::string text = part(file);
    return text.empty() ? std::nullopt : std::optional{std::move(text)};
}

std::string TakenOverFiles::part(std::string_view name)
{
    const auto bytes = read_file(*storage_, storage_path(folder, name), max_part_size);
    if (!bytes) {
        return {};
    }
    std::string_view rest{reinterpret_cast<const char*>(bytes->data()), bytes->size()};
    const auto sum = take_until(rest, '\n');
    if (!sum || *sum != controller::detail::checksum_text(rest)) {
        return {};
    }
    known_.insert_or_assign(std::string{name}, std::string{*sum});
    return std::string{rest};
}

std::optional<TakenOver> TakenOverFiles::read()
{
    storage_->remove_unfinished(folder);
    TakenOver all;
    all.files = files_in(part(files_name)).value_or(SourceFiles::Texts{});
    if (std::string project = part(project_name); !project.empty()) {
        all.project = std::make_shared<const std::string>(std::move(project));
    }
    if (std::string settings = part(settings_name); !settings.empty()) {
        all.settings = std::move(settings);
    }
    all.listeners = listeners_in(part(listeners_name)).value_or(std::vector<FurtherListener>{});
    return known_.empty() ? std::nullopt : std::optional{std::move(all)};
}

} // namespace busbar::product
