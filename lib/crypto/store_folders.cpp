#include "store_folders.hpp"

#include <array>
#include <string>

#include <busbar/core/status_codes.hpp>
#include <busbar/core/text.hpp>

#include "core/unfinished.hpp"

namespace busbar::crypto::detail {

namespace {

/// Part 12, F.1.
constexpr std::array folders = {"own/certs",     "own/crl",     "trusted/certs",  "trusted/crl",
                                "issuers/certs", "issuers/crl", "rejected/certs", "rejected/crl"};
constexpr const char* private_folder = "own/private";
constexpr std::size_t max_private_files = 10'000;

/// Restricts a file or folder to its owner from now on.
void close_to_others(Storage& storage, const std::string& name, LogSink& log)
{
    const auto closed = storage.close_to_others(name);
    if (closed ? !*closed : closed.error() == StorageError::NotFound) {
        return;
    }
    log.write(LogLevel::Warning, "certificate store",
              printable(storage.place(name)) + " was open to other users than its owner; " +
                  (closed ? "it is closed now" : "it cannot be closed") +
                  ". If a private key there may have been read, replace it");
}

void close_private_keys(Storage& storage, LogSink& log)
{
    close_to_others(storage, private_folder, log);
    const auto found = storage.list(private_folder, max_private_files);
    if (!found) {
        return;
    }
    for (const StorageEntry& entry : found->entries) {
        if (entry.kind == StorageEntry::Kind::File) {
            close_to_others(storage, storage_path(private_folder, entry.name), log);
        }
    }
}

} // namespace

Result<void> make_store_folders(Storage& storage, LogSink& log)
{
    for (const char* name : folders) {
        if (!storage.make_folder(name, FileAccess::Everyone)) {
            return fail(status::Bad_ConfigurationError);
        }
    }
    if (!storage.make_folder(private_folder, FileAccess::Owner)) {
        return fail(status::Bad_ConfigurationError);
    }
    busbar::detail::remove_unfinished_below(storage, "");
    close_private_keys(storage, log);
    return {};
}

} // namespace busbar::crypto::detail
