#include <functional>
#include <utility>

#include "own_store.hpp"
#include "support/effort.hpp"
#include "support/failing_disk.hpp"

namespace own_power_cut_test {

using namespace busbar;
using namespace busbar::test;

namespace {

const crypto::PrivateKey& old_key()
{
    return key_number(2);
}

const crypto::PrivateKey& requested_key()
{
    return key_number(3);
}

const OwnCertificate& requested()
{
    static const OwnCertificate result{{issue({}, requested_key(), &ca()).certificate},
                                       requested_key()};
    return result;
}

const OwnCertificate& foreign()
{
    static const OwnCertificate result{{issue({}, key_number(1), &ca()).certificate},
                                       key_number(1)};
    return result;
}

std::string text_of(const crypto::PrivateKey& key)
{
    return std::string{key.to_pem()->text()};
}

/// What happens to a store while the power goes.
struct Case {
    bool has_old;     // a certificate and its key are in force
    bool has_request; // a key is pending
    std::function<Checked<OwnCertificate>(const OwnCertificateStore&)> change;
};

Checked<OwnCertificate> take_in(const OwnCertificateStore& store)
{
    return store.take_in(requested().certificates.front().der(), uri);
}

Checked<OwnCertificate> install(const OwnCertificateStore& store)
{
    return store.install(foreign(), uri);
}

Checked<OwnCertificate> start(const OwnCertificateStore& store)
{
    return store.load_or_create(settings(), now);
}

Checked<OwnCertificate> regenerate(const OwnCertificateStore& store)
{
    return store.regenerate(settings(), now);
}

Checked<OwnCertificate> renew(const OwnCertificateStore& store)
{
    static const auto renewed = issue({}, old_key(), &ca()).certificate;
    return store.take_in(renewed.der(), uri);
}

/// No key lies anywhere where others can read it, also in files that were not finished.
void check_secrecy(const fs::path& folder)
{
    for (const auto& entry : fs::recursive_directory_iterator{folder}) {
        if (entry.is_regular_file() && read(entry.path()).find("PRIVATE") != std::string::npos) {
            CHECK(mode_of(entry.path()) == 0600);
        }
    }
}

/// A store in which a case happens again and again.
class Victim {
public:
    explicit Victim(Case which) : case_{std::move(which)}
    {
        if (case_.has_old) {
            old_ = OwnCertificate{{issue({}, old_key()).certificate}, old_key()};
            before_.put({old_->certificates.front(), old_key()});
        }
        if (case_.has_request) {
            Store::put_key(before_.pending(), requested_key());
        }
        begin();
        steps = failing_disk::steps_of([&] { REQUIRE(run()); });
    }

    void begin()
    {
        store_.emplace();
        fs::copy(before_.folder.path, store_->folder.path, fs::copy_options::recursive);
    }
    bool run()
    {
        const auto result = case_.change(store_->store);
        made_ = result ? std::optional{*result} : std::nullopt;
        return result.has_value();
    }
    /// What was in force is, or what the change makes; gives whether it is the latter. `knows`: the
    /// change has told whether it succeeded.
    bool check(bool knows)
    {
        check_secrecy(store_->folder.path);
        const auto loaded = store_->store.load(uri);
        REQUIRE(loaded);
        const bool is_new = *loaded && !(old_ && is_same(**loaded, *old_));
        CHECK((is_new || loaded->has_value() == old_.has_value()));
        if (knows) {
            CHECK(is_new == made_.has_value());
            CHECK((!made_ || is_same(**loaded, *made_)));
        }
        if (!is_new && !old_) {
            CHECK(read(store_->pending()) == text_of(requested_key()));
        }
        // And life goes on.
        CHECK(is_same(*install(store_->store), foreign()));
        CHECK(is_same(**store_->store.load(uri), foreign()));
        check_nothing_is_lost();
        return is_new;
    }

    failing_disk::Steps steps;

private:
    void check_nothing_is_lost() const
    {
        if (old_) {
            const auto stem = store_->replaced() / old_->certificates.front().thumbprint_text();
            CHECK(read(stem.string() + ".der") == test::text_of(old_->certificates.front().der()));
            CHECK(read(stem.string() + ".pem") == text_of(old_key()));
        }
        check_replaced_pairs();
    }

    /// Nobody who looks for an old key shall find another one under its name.
    void check_replaced_pairs() const
    {
        for (const auto& entry : fs::directory_iterator{store_->replaced()}) {
            fs::path key = entry.path();
            key.replace_extension(".pem");
            if (entry.path().extension() != ".der" || !fs::exists(key)) {
                continue;
            }
            const std::string der = read(entry.path());
            const std::string pem = read(key);
            const auto chain = crypto::parse_chain(std::as_bytes(std::span{der}));
            const auto parsed = crypto::PrivateKey::parse(std::as_bytes(std::span{pem}));
            REQUIRE(chain);
            REQUIRE(parsed);
            CHECK(parsed->belongs_to(chain->front()));
        }
    }

    Case case_;
    Store before_;
    std::optional<OwnCertificate> old_;
    std::optional<Store> store_;
    std::optional<OwnCertificate> made_;
};

/// Whether this way of failing has its turn at that call: each has one call in three, another one
/// every day, and the last of all, unless the effort is full.
bool is_tried(const Victim& victim, std::size_t call, std::size_t way)
{
    constexpr std::size_t ways = 3;
    return is_full_effort() || call + 1 == victim.steps.calls.size() ||
           (call + way) % ways == part_of_round("own power cut", ways);
}

void cut_everywhere(const Case& which, std::size_t least_calls)
{
    Victim victim{which};
    const auto& calls = victim.steps.calls;
    REQUIRE(calls.size() >= least_calls);
    bool was_new = false;
    for (std::size_t i = 0; i < calls.size(); ++i) {
        INFO("after " << calls[i] << " of " << victim.steps.count << " steps");
        if (is_tried(victim, i, 0)) {
            victim.begin();
            failing_disk::run_until_dark(calls[i], [&] { victim.run(); });
            const bool is_new = victim.check(true);
            CHECK((is_new || !was_new));
            was_new = is_new;
        }
        if (is_tried(victim, i, 1)) {
            victim.begin();
            REQUIRE(failing_disk::run_until_killed(calls[i], [&] { victim.run(); }));
            victim.check(false);
        }
        if (is_tried(victim, i, 2)) {
            victim.begin();
            failing_disk::run_with_failure(calls[i], [&] { victim.run(); });
            victim.check(true);
        }
    }
    CHECK(was_new);
}

} // namespace

TEST_CASE("a power cut while a certificate is taken in leaves the old pair or the new one",
          "[crypto][own][power]")
{
    cut_everywhere({true, true, take_in}, 20);
}

TEST_CASE("a power cut while the first certificate is taken in leaves none or all of it",
          "[crypto][own][power]")
{
    cut_everywhere({false, true, take_in}, 10);
}

TEST_CASE("a power cut while a certificate is renewed leaves the old one or the new one",
          "[crypto][own][power]")
{
    cut_everywhere({true, false, renew}, 10);
}

TEST_CASE("a power cut while a pair is installed leaves the old pair or the new one",
          "[crypto][own][power]")
{
    cut_everywhere({true, false, install}, 20);
}

TEST_CASE("a power cut at the first start leaves none or all, and the request's key",
          "[crypto][own][power]")
{
    cut_everywhere({false, true, start}, 10);
}

TEST_CASE("a power cut while a certificate is made anew leaves the old pair or the new one",
          "[crypto][own][power]")
{
    // The round's sixth unless the effort is full.
    Victim victim{{true, false, regenerate}};
    const auto& calls = victim.steps.calls;
    const std::size_t parts = is_full_effort() ? 1 : 6;
    for (std::size_t i = part_of_round("regenerate", parts); i < calls.size(); i += parts) {
        INFO("after " << calls[i] << " of " << victim.steps.count << " steps");
        victim.begin();
        failing_disk::run_until_dark(calls[i], [&] { victim.run(); });
        victim.check(true);
    }
}

TEST_CASE("two power cuts in a row lose no key", "[crypto][own][power]")
{
    Store before;
    before.put({issue({}, old_key()).certificate, old_key()});
    Store::put_key(before.pending(), requested_key());
    const auto copy = [&](const Store& from, Store& to) {
        fs::copy(from.folder.path, to.folder.path, fs::copy_options::recursive);
    };
    const auto calls_of = [&](const Store& store, auto change) {
        Store copied;
        copy(store, copied);
        return failing_disk::steps_of([&] { REQUIRE(change(copied.store)); }).calls;
    };
    const auto first_calls = calls_of(before, take_in);
    const Turns turns{"two power cuts", 3};
    for (std::size_t call = turns.first; call < first_calls.size(); call += turns.stride) {
        const std::size_t first = first_calls[call];
        Store once;
        copy(before, once);
        failing_disk::run_until_dark(first, [&] { static_cast<void>(take_in(once.store)); });
        // The next thing that is done is done to a store that nobody has loaded meanwhile.
        const auto calls = calls_of(once, install);
        for (std::size_t i = first % 3; i < calls.size(); i += 3) {
            INFO("after " << first << " steps and " << calls[i]);
            Store twice;
            copy(once, twice);
            failing_disk::run_until_dark(calls[i],
                                         [&] { static_cast<void>(install(twice.store)); });
            const auto loaded = twice.store.load(uri);
            REQUIRE(loaded);
            CHECK(loaded->has_value());
        }
    }
}

} // namespace own_power_cut_test
