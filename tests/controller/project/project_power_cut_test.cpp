#include <catch2/catch.hpp>

#include <functional>
#include <map>
#include <span>
#include <string>

#include <busbar/controller/project_store.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "project_fixture.hpp"
#include "support/effort.hpp"

namespace project_power_cut_test {

using namespace busbar;
using namespace busbar::controller;
using test::Turns;

namespace {

std::string project_document(const std::string& host)
{
    Project project = test::press_project();
    project.network.host_name = host;
    return *document_of(project);
}

const std::string& old_document()
{
    static const std::string document = project_document("OLD");
    return document;
}

const std::string& new_document()
{
    static const std::string document = project_document("NEW");
    return document;
}

/// A server that has the old project; empty: it has none.
struct KeptProject {
    explicit KeptProject(const std::string& document)
    {
        REQUIRE(store.recover());
        if (!document.empty()) {
            REQUIRE(store.replace(std::as_bytes(std::span{document})));
        }
    }
    /// In parts, as a tool sends it; `between` them another one does something.
    bool transfer(const std::function<void(std::uint32_t number)>& between = {})
    {
        const auto number = store.begin();
        bool goes_on = number.has_value();
        const auto bytes = std::as_bytes(std::span{new_document()});
        for (std::size_t at = 0; goes_on && at < bytes.size(); at += 500) {
            if (between) {
                between(*number);
            }
            goes_on = store
                          .write(*number,
                                 bytes.subspan(at, std::min<std::size_t>(500, bytes.size() - at)))
                          .has_value();
        }
        return goes_on && store.commit(*number);
    }
    /// What a server has that starts on this storage now.
    [[nodiscard]] std::string restarted()
    {
        ProjectStore again{storage, "project", {}};
        REQUIRE(again.recover());
        REQUIRE(storage.names().size() == (again.current() != nullptr ? 1 : 0));
        return again.current() != nullptr ? *again.document() : std::string{};
    }

    storage::MemoryStorage storage;
    ProjectStore store{storage, "project", {}};
};

} // namespace

TEST_CASE("9.13 A transfer is whole or not done after a power cut at any byte",
          "[power_cut][project][9.13]")
{
    for (const std::string& before : {old_document(), std::string{}}) {
        std::size_t old_ones = 0;
        bool is_undisturbed = false;
        const Turns cuts{"a transfer", 5};
        for (std::size_t step = cuts.first; !is_undisturbed && step < 20'000; step += cuts.stride) {
            KeptProject server{before};
            server.storage.cut_power_after(step);
            const bool is_done = server.transfer();
            const bool is_dark = !server.storage.free_space();
            const bool runs_old = server.store.current() == nullptr ||
                                  server.store.current()->network.host_name == "OLD";
            if (runs_old == is_done) {
                FAIL("another project runs than was said, after " << step << " steps");
            }
            server.storage.restore_power();
            const std::string found = server.restarted();
            if (found != new_document() && (is_done || found != before)) {
                FAIL("half of it is done after " << step << " steps");
            }
            old_ones += found == before ? cuts.stride : 0U;
            is_undisturbed = !is_dark;
        }
        CHECK(is_undisturbed);
        CHECK(old_ones > new_document().size());
    }
}

TEST_CASE("9.13 Of two tools at once the second changes nothing, wherever the power goes",
          "[power_cut][project][9.13]")
{
    std::size_t refusals = 0;
    bool is_undisturbed = false;
    const Turns cuts{"two tools", 5};
    for (std::size_t step = cuts.first; !is_undisturbed && step < 20'000; step += cuts.stride) {
        KeptProject server{old_document()};
        server.storage.cut_power_after(step);
        const bool is_done = server.transfer([&](std::uint32_t number) {
            refusals += server.store.begin() ? 0U : 1U;
            refusals += server.store.write(number + 1, std::as_bytes(std::span{"x"})) ? 0U : 1U;
            refusals += server.store.commit(number + 1) ? 0U : 1U;
            server.store.cancel(number + 1);
        });
        is_undisturbed = server.storage.free_space().has_value();
        server.storage.restore_power();
        const std::string found = server.restarted();
        if (found != new_document() && (is_done || found != old_document())) {
            FAIL("half of it is done after " << step << " steps");
        }
        if (is_undisturbed && !is_done) {
            FAIL("the second tool has ended the first one's transfer");
        }
    }
    CHECK(is_undisturbed);
    CHECK(refusals * cuts.stride > new_document().size());
    CHECK(refusals % 3 == 0); // nothing of it was ever taken
}

TEST_CASE("9.13 A step of a transfer that fails leaves the old project, and the next one succeeds",
          "[power_cut][project][9.13]")
{
    for (const StorageError error :
         {StorageError::Failed, StorageError::Full, StorageError::Protected, StorageError::Away}) {
        std::size_t failed = 0;
        for (std::size_t step = 0; step < new_document().size() + 20; ++step) {
            // The bytes are all alike; what is before and behind them is not.
            if (step > 100 && step + 100 < new_document().size() && step % 37 != 0) {
                continue;
            }
            KeptProject server{old_document()};
            server.storage.fail_once_after(step, error);
            const bool is_done = server.transfer();
            failed += is_done ? 0U : 1U;
            REQUIRE_FALSE(server.store.is_busy());
            REQUIRE(*server.store.document() == (is_done ? new_document() : old_document()));
            if (!is_done) {
                REQUIRE(server.transfer());
            }
            REQUIRE(server.restarted() == new_document());
        }
        CHECK(failed > 100);
    }
}

TEST_CASE("9.13 A medium that is full, protected or away changes nothing",
          "[power_cut][project][9.13]")
{
    using Fault = std::function<void(storage::MemoryStorage&, bool)>;
    const std::map<std::string, Fault> faults{
        {"full",
         [](auto& storage, bool is_on) {
             storage.set_capacity(is_on ? old_document().size() + 600 : UINT64_MAX);
         }},
        {"protected", [](auto& storage, bool is_on) { storage.set_protected(is_on); }},
        {"away", [](auto& storage, bool is_on) { storage.set_away(is_on); }},
    };
    for (const auto& [name, set] : faults) {
        INFO(name);
        KeptProject server{old_document()};
        set(server.storage, true);
        CHECK_FALSE(server.transfer());
        REQUIRE(server.store.current() != nullptr);
        CHECK(server.store.current()->network.host_name == "OLD");
        set(server.storage, false);
        CHECK(server.restarted() == old_document());
        CHECK(server.transfer());
        CHECK(server.restarted() == new_document());
    }
}

TEST_CASE("9.13 A power cut while a power cut is mended is mended, too",
          "[power_cut][project][9.13]")
{
    const std::size_t last = new_document().size() + 10;
    for (std::size_t first = 0; first < last; first += first + 100 < last ? 97 : 1) {
        for (std::size_t second = 0; second < 3; ++second) {
            KeptProject server{old_document()};
            server.storage.cut_power_after(first);
            const bool is_done = server.transfer();
            server.storage.restore_power();
            server.storage.cut_power_after(second);
            ProjectStore mended{server.storage, "project", {}};
            static_cast<void>(mended.recover());
            server.storage.restore_power();
            const std::string found = server.restarted();
            REQUIRE((found == new_document() || (!is_done && found == old_document())));
        }
    }
}

} // namespace project_power_cut_test
