#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include <busbar/crypto/certificate_store.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "fuzz_root.hpp"
#include "fuzz_script.hpp"

namespace certificate_store_fuzz {

using namespace busbar;
using namespace busbar::crypto;
using fuzz::Script;

namespace {

constexpr std::array lists{StoreList::Own, StoreList::Trusted, StoreList::Issuers,
                           StoreList::Rejected};

StoreLimits small_limits()
{
    StoreLimits limits;
    limits.max_certificates = limits.max_revocation_lists = limits.max_rejected = 3;
    limits.max_files = 8;
    limits.max_folder_size = 20'000;
    return limits;
}

std::span<const std::byte> contents(Script& script)
{
    return script.byte() % 4 == 0 ? test::fuzz_root().der() : script.bytes(script.byte() * 8U);
}

/// Somebody lays a file down, where it belongs or not.
void lay_down(storage::MemoryStorage& files, Script& script)
{
    static constexpr std::array<std::string_view, 6> folders{
        "trusted/certs", "trusted/crl", "issuers/certs", "own/certs", "rejected/certs", "trusted"};
    static constexpr std::array<std::string_view, 4> endings{".der", ".crl", ".pem", ""};
    std::string name{folders[script.byte() % folders.size()]};
    name += '/' + std::string(script.byte() % 3U + 1U, 'n');
    name += endings[script.byte() % endings.size()];
    static_cast<void>(files.replace(name, contents(script), FileAccess::Owner));
}

/// All that may be asked of what lies there.
void look(CertificateStore& store, DateTime now)
{
    const TrustList& list = store.trust_list(now);
    const StoreLimits limits = small_limits();
    if (list.trusted.size() > limits.max_certificates ||
        list.issuers.size() > limits.max_certificates) {
        __builtin_trap();
    }
    for (const StoreList each : lists) {
        for (const StoreEntry& entry : store.list(each)) {
            if (!store.show(entry.thumbprint)) {
                __builtin_trap();
            }
        }
    }
}

std::string thumbprint(CertificateStore& store, StoreList list, Script& script)
{
    const auto entries = store.list(list);
    return entries.empty() ? "none" : entries[script.byte() % entries.size()].thumbprint;
}

} // namespace

/// A store whose files come and go by anybody's hands, and what an administrator does with it.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    Script script{{data, size}};
    storage::MemoryStorage files;
    NullLog log;
    CertificateStore store{files, small_limits(), log};
    static_cast<void>(store.create());
    DateTime now = test::fuzz_time;
    for (int step = 0; step < 24 && !script.is_over(); ++step) {
        const StoreList list = lists[script.byte() % lists.size()];
        switch (script.byte() % 6) {
        case 0:
            static_cast<void>(store.add(list, contents(script)));
            break;
        case 1:
            static_cast<void>(store.remove(list, thumbprint(store, list, script)));
            break;
        case 2:
            static_cast<void>(store.move(thumbprint(store, list, script), list,
                                         lists[script.byte() % lists.size()]));
            break;
        case 3:
            store.reject(test::fuzz_root(), now);
            break;
        default:
            lay_down(files, script);
        }
        now.ticks += script.byte() * DateTime::ticks_per_second;
        files.set_time(now);
        look(store, now);
    }
    return 0;
}

} // namespace certificate_store_fuzz
