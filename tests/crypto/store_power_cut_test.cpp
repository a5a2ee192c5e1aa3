#include <utility>

#include <sys/stat.h>

#include <busbar/crypto/certificate_store.hpp>

#include "revoking.hpp"
#include "store_fixture.hpp"
#include "support/effort.hpp"
#include "support/failing_disk.hpp"

namespace store_power_cut_test {

using namespace busbar;
using namespace busbar::test;
using crypto::Certificate;
using crypto::CertificateStore;
using crypto::StoreLimits;
using crypto::StoreList;

namespace {

/// What a store holds, by thumbprint.
struct State {
    std::set<std::string> trusted;
    std::set<std::string> issuers;
    std::set<std::string> rejected;
    std::string key;

    friend bool operator==(const State&, const State&) = default;
};

/// True if it reports success.
using Operation = std::function<bool(CertificateStore&)>;

std::string contents_of(const fs::path& file)
{
    std::ifstream stream{file, std::ios::binary};
    return {std::istreambuf_iterator<char>{stream}, {}};
}

/// A store on a disk that fails: each time the same store, and what is left of it afterwards.
class Victim {
public:
    explicit Victim(Operation operation) : operation_{std::move(operation)}
    {
        limits_.max_rejected = 2;
        begin();
        before = state();
        steps = failing_disk::steps_of([&] { REQUIRE(run()); });
        after = state();
        REQUIRE(before != after);
        begin();
    }

    /// The store as it was, with a certificate in each list.
    void begin()
    {
        fs::remove_all(folder_.path);
        LogBook log;
        REQUIRE(CertificateStore{files_, limits_, log}.create());
        put("trusted/certs/a.der", certificates()[0]);
        put("issuers/certs/b.der", certificates()[1]);
        for (std::size_t i = 2; i < 4; ++i) {
            const auto file = "rejected/certs/" + std::to_string(i) + ".der";
            put(file, certificates()[i]);
            fs::last_write_time(folder_.path / file, fs::file_time_type{} + std::chrono::hours{i});
        }
        write_text(key_file(), "old key");
        fs::permissions(key_file(), fs::perms{0600});
    }

    bool run()
    {
        LogBook log;
        CertificateStore store{files_, limits_, log};
        return operation_(store);
    }

    /// After the power is back. Whatever is left of an unfinished file is not read, whoever may
    /// read it is its owner, and create() removes it; no file that counts is half.
    State restart(bool is_thorough = true)
    {
        for (const auto& entry : fs::directory_iterator{folder_.path / "own/private"}) {
            REQUIRE(mode_of(entry.path()) == 0600);
        }
        const State found = state();
        REQUIRE(CertificateStore{files_, limits_, log_}.create());
        REQUIRE(unfinished_files() == 0);
        REQUIRE(log_.lines.empty());
        REQUIRE((!is_thorough || state() == found));
        return found;
    }

    [[nodiscard]] std::size_t unfinished_files() const
    {
        std::size_t count = 0;
        for (const auto& entry : fs::recursive_directory_iterator{folder_.path}) {
            count += static_cast<std::size_t>(is_unfinished(entry.path()));
        }
        return count;
    }

    State state()
    {
        CertificateStore store{files_, limits_, log_};
        const auto in = [&](StoreList list) {
            std::set<std::string> result;
            for (const crypto::StoreEntry& entry : store.list(list)) {
                result.insert(entry.thumbprint);
            }
            return result;
        };
        return {in(StoreList::Trusted), in(StoreList::Issuers), in(StoreList::Rejected),
                contents_of(key_file())};
    }

    static const std::vector<Certificate>& certificates()
    {
        static const std::vector<Certificate> all = [] {
            std::vector<Certificate> result;
            for (int i = 0; i < 6; ++i) {
                result.push_back(issue({}, key_number(1)).certificate);
            }
            return result;
        }();
        return all;
    }
    [[nodiscard]] fs::path key_file() const { return folder_.path / "own/private/own.pem"; }

    State before;
    State after;
    failing_disk::Steps steps;

private:
    void put(const std::string& name, const Certificate& certificate) const
    {
        write_file(folder_.path / name, certificate.der());
    }

    TemporaryFolder folder_;
    storage::FolderStorage files_{folder_.path.string()};
    StoreLimits limits_;
    LogBook log_;
    Operation operation_;
};

bool is_between(const std::set<std::string>& now, const std::set<std::string>& before,
                const std::set<std::string>& after)
{
    const auto in = [](const std::set<std::string>& set) {
        return [&set](const std::string& one) { return set.count(one) != 0; };
    };
    return std::all_of(now.begin(), now.end(),
                       [&](const auto& one) { return in(before)(one) || in(after)(one); }) &&
           std::all_of(before.begin(), before.end(),
                       [&](const auto& one) { return !in(after)(one) || in(now)(one); });
}

std::set<std::string> all_of(const State& state)
{
    std::set<std::string> all = state.trusted;
    all.insert(state.issuers.begin(), state.issuers.end());
    all.insert(state.rejected.begin(), state.rejected.end());
    return all;
}

/// Two steps that each may be done or not: but nothing else changed, and nothing that the operation
/// keeps is lost.
bool is_on_the_way(const State& now, const State& before, const State& after)
{
    return is_between(now.trusted, before.trusted, after.trusted) &&
           is_between(now.issuers, before.issuers, after.issuers) &&
           is_between(now.rejected, before.rejected, after.rejected) &&
           is_between(all_of(now), all_of(before), all_of(after)) && now.key == before.key;
}

enum class Allows { OldOrNew, Both };

void check(Victim& victim, std::size_t step, Allows allows)
{
    const auto& calls = victim.steps.calls;
    const State now = victim.restart(std::find(calls.begin(), calls.end(), step) != calls.end());
    INFO("after " << step << " of " << victim.steps.count << " steps");
    const bool is_whole = now == victim.before || now == victim.after;
    REQUIRE(
        (is_whole || (allows == Allows::Both && is_on_the_way(now, victim.before, victim.after))));
    if (now != victim.before) {
        victim.begin();
    }
}

/// True for the first and the last byte of a write, for every other step, and for the bytes between
/// of which another sixth has its turn every day, unless the effort is full.
bool is_cut(const std::vector<std::size_t>& calls, std::size_t step)
{
    constexpr std::size_t parts = 6;
    return is_full_effort() || step % parts == part_of_round("store power cut", parts) ||
           std::find(calls.begin(), calls.end(), step) != calls.end();
}

/// The power goes after every byte (see is_cut) and every other step; at every call the process is
/// killed, and the disk is full.
void cut_everywhere(const Operation& operation, std::size_t least_steps,
                    Allows allows = Allows::OldOrNew)
{
    Victim victim{operation};
    REQUIRE(victim.steps.count >= least_steps);
    for (std::size_t step = 0; step < victim.steps.count; ++step) {
        if (!is_cut(victim.steps.calls, step)) {
            continue;
        }
        failing_disk::run_until_dark(step, [&] { victim.run(); });
        check(victim, step, allows);
    }
    for (const std::size_t step : victim.steps.calls) {
        REQUIRE(failing_disk::run_until_killed(step, [&] { victim.run(); }));
        check(victim, step, allows);
        bool is_done = false;
        failing_disk::run_with_failure(step, [&] { is_done = victim.run(); });
        REQUIRE(victim.unfinished_files() == 0);
        REQUIRE(
            (allows == Allows::Both || victim.state() == (is_done ? victim.after : victim.before)));
        check(victim, step, allows);
    }
    victim.run();
    CHECK(victim.restart() == victim.after);
}

class TwoDisks {
public:
    TwoDisks() { failing_disk::set_two_disks(true); }
    TwoDisks(const TwoDisks&) = delete;
    TwoDisks& operator=(const TwoDisks&) = delete;
    ~TwoDisks() { failing_disk::set_two_disks(false); }
};

} // namespace

TEST_CASE("a power cut leaves an added certificate whole or not at all", "[crypto][store][power]")
{
    const Certificate& added = Victim::certificates()[5];
    cut_everywhere(
        [&](CertificateStore& store) -> bool {
            return !!store.add(StoreList::Trusted, added.der());
        },
        added.der().size() + 4);
}

TEST_CASE("a power cut leaves an added revocation list whole or not at all",
          "[crypto][store][power]")
{
    const auto list = revoke(issue(authority("root"), key_number(2)));
    cut_everywhere(
        [&](CertificateStore& store) -> bool {
            return !!store.add(StoreList::Issuers, list.der());
        },
        list.der().size() + 4);
}

TEST_CASE("a power cut leaves a moved certificate in one of both lists", "[crypto][store][power]")
{
    const auto move = [](CertificateStore& store) -> bool {
        return !!store.move(Victim::certificates()[3].thumbprint_text(), StoreList::Rejected,
                            StoreList::Trusted);
    };
    cut_everywhere(move, 3);
    // On two disks it is a copy and a removal.
    const TwoDisks two;
    cut_everywhere(move, Victim::certificates()[3].der().size() + 6, Allows::Both);
}

TEST_CASE("a power cut leaves a removed certificate there or gone", "[crypto][store][power]")
{
    cut_everywhere(
        [](CertificateStore& store) -> bool {
            return !!store.remove(StoreList::Trusted, Victim::certificates()[0].thumbprint_text());
        },
        2);
}

TEST_CASE("a power cut loses no rejected certificate but the oldest", "[crypto][store][power]")
{
    const Certificate& stranger = Victim::certificates()[5];
    cut_everywhere(
        [&](CertificateStore& store) {
            store.reject(stranger, now);
            return true;
        },
        stranger.der().size() + 6, Allows::Both);
}

TEST_CASE("a power cut leaves the old private key or the new one", "[crypto][store][power]")
{
    cut_everywhere(
        [](CertificateStore& store) -> bool {
            return !!key_number(1).save(store.storage(), "own/private/own.pem");
        },
        1'600);
}

TEST_CASE("no part of a file is accepted", "[crypto][store][power]")
{
    // What a tool leaves that does not write as carefully.
    StoreFixture fixture;
    const Certificate one = Victim::certificates()[0];
    const auto list = revoke(issue(authority("root"), key_number(2)));
    const auto pem = pem_of(one);
    for (std::size_t size = 0; size < pem.size(); ++size) {
        if (!is_cut({0, one.der().size() - 1, list.der().size() - 1, pem.size() - 1}, size)) {
            continue;
        }
        fixture.put("trusted/certs/a.der", one.der().first(std::min(size, one.der().size() - 1)));
        fixture.put("trusted/crl/a.crl", list.der().first(std::min(size, list.der().size() - 1)));
        fixture.put("issuers/certs/a.pem", std::span{pem}.first(size));
        const auto& trust = fixture.store.trust_list(now);
        REQUIRE(trust.trusted.empty());
        REQUIRE(trust.trusted_crls.empty());
        // All but the line's end is all.
        REQUIRE((trust.issuers.empty() || (size == pem.size() - 1 && trust.issuers[0] == one)));
    }
}

namespace {

/// Changes the file's mode until the system gives it another time of change: two changes within one
/// tick of its clock have the same one.
void change_mode(const fs::path& path)
{
    const auto changed_at = [&] {
        struct stat status {};
        REQUIRE(::stat(path.c_str(), &status) == 0);
        return std::pair{status.st_ctim.tv_sec, status.st_ctim.tv_nsec};
    };
    const auto before = changed_at();
    while (changed_at() == before) {
        fs::permissions(path, fs::perms{0600});
    }
}

} // namespace

TEST_CASE("a file that did not change is not read again", "[crypto][store]")
{
    StoreFixture fixture;
    for (int i = 0; i < 5; ++i) {
        fixture.put("trusted/certs/" + std::to_string(i), Victim::certificates()[0].der());
    }
    const auto reads = [&](DateTime time) {
        const std::size_t before = failing_disk::count_of_reads();
        CHECK(fixture.store.trust_list(time).trusted.size() == 5);
        return failing_disk::count_of_reads() - before;
    };
    CHECK(reads(long_after()) == 5);
    CHECK(reads(long_after()) == 0);
    // While files are fresh by the clock, they are.
    CHECK(reads(now) == 5);
    change_mode(fixture.path("trusted/certs/3"));
    CHECK(reads(long_after()) == 1);
    CHECK(reads(long_after()) == 0);
}

} // namespace store_power_cut_test
