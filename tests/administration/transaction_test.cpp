#include "administration/transaction.hpp"

#include "managed_fixture.hpp"

namespace transaction_test {

// A transaction of Part 12, 7.10.2 on a medium whose power goes: a trust list, that of users and
// the own certificate are all old or all new. FileTransaction, by which they are written, has a
// test that cuts it at every byte; this one takes some of them.

using namespace busbar;
using namespace busbar::test;

namespace {

using administration::detail::Transaction;
using crypto::StoreList;

const NodeId session{0, 1};

channel::ApplicationIdentity successor()
{
    crypto::CertificateSubject subject;
    subject.common_name = "server";
    subject.application_uri = "urn:busbar:test:server";
    subject.valid_from = today;
    const auto& key = key_number(5);
    return {{crypto::create_self_signed(key, subject).value()}, key};
}

/// What a program would find that starts now.
std::string state_of(Storage& storage)
{
    LogBook log;
    StorageFolder users_folder{storage, "users"};
    crypto::CertificateStore applications{storage, {}, log};
    crypto::CertificateStore users{users_folder, {}, log};
    REQUIRE(administration::finish_changes(storage));
    const auto own = crypto::OwnCertificateStore{storage}.load("urn:busbar:test:server");
    REQUIRE(own);
    REQUIRE(*own);
    std::string text = "own " + (*own)->certificates.front().thumbprint_text();
    CHECK((*own)->key.belongs_to((*own)->certificates.front()));
    for (auto* store : {&applications, &users}) {
        for (const auto& entry : store->list(StoreList::Trusted)) {
            text += " " + entry.thumbprint;
        }
    }
    return text;
}

struct World {
    World()
    {
        REQUIRE(applications.create());
        REQUIRE(users.create());
        REQUIRE(applications.add(StoreList::Trusted, client_identity().certificates.front().der()));
        REQUIRE(crypto::OwnCertificateStore{storage}.install(
            {server_identity().certificates, server_identity().key}, "urn:busbar:test:server"));
        transaction.groups().push_back({NodeId{0, 1}, NodeId{0, 2}, &applications, "",
                                        crypto::CertificatePurpose::Application, 0});
        transaction.groups().push_back(
            {NodeId{0, 3}, NodeId{0, 4}, &users, "users", crypto::CertificatePurpose::User, 0});
    }

    bool change(bool has_own = true)
    {
        static const auto next = successor();
        static const auto stranger = issue({}, key_number(1)).certificate;
        REQUIRE(transaction.enter(session) == status::Good);
        crypto::TrustList list;
        list.trusted = {stranger};
        transaction.set_trust_list(0, list, {.trusted = true});
        transaction.set_trust_list(1, list, {.trusted = true});
        if (has_own) {
            transaction.set_own_certificate({next.certificates, next.key});
        }
        return !!transaction.apply("urn:busbar:test:server");
    }

    storage::MemoryStorage storage;
    StorageFolder users_folder{storage, "users"};
    LogBook log;
    FixedWallClock clock;
    crypto::CertificateStore applications{storage, {}, log};
    crypto::CertificateStore users{users_folder, {}, log};
    administration::ManagedCertificates files{.files = &storage, .applications = &applications};
    Transaction transaction{files, clock};
};

} // namespace

TEST_CASE("transaction: whole or not at all when the power goes", "[power]")
{
    std::string before;
    std::string after;
    {
        World world;
        before = state_of(world.storage);
        REQUIRE(world.change());
        after = state_of(world.storage);
    }
    REQUIRE(before != after);
    bool is_done = false;
    std::size_t old_ones = 0;
    std::size_t new_ones = 0;
    constexpr std::size_t stride = 29;
    for (std::size_t step = 0; !is_done && step < 100'000; step += stride) {
        World world;
        world.storage.cut_power_after(step);
        is_done = world.change();
        world.storage.restore_power();
        const std::string state = state_of(world.storage);
        CHECK((state == before || state == after));
        (state == before ? old_ones : new_ones) += 1;
        if (!is_done) {
            CHECK_FALSE(world.transaction.is_active());
        }
    }
    CHECK(is_done);
    CHECK(old_ones > 10);
    CHECK(new_ones > 0);
}

TEST_CASE("transaction: a medium that is full or protected leaves all as it was", "[power]")
{
    World world;
    const std::string before = state_of(world.storage);
    world.storage.set_capacity(10);
    CHECK_FALSE(world.change());
    world.storage.set_capacity(UINT64_MAX);
    CHECK(state_of(world.storage) == before);
    world.storage.set_protected(true);
    CHECK_FALSE(world.change());
    world.storage.set_protected(false);
    CHECK(state_of(world.storage) == before);
    CHECK(world.change());
    CHECK(state_of(world.storage) != before);
}

TEST_CASE("transaction: a store's list with a name that is taken, or too long, is refused whole")
{
    World world;
    crypto::TrustList list;
    for (std::size_t i = 0; i < 257; ++i) {
        CertificateOptions options;
        options.common_name = "client " + std::to_string(i);
        list.trusted.push_back(issue(options, key_number(1)).certificate);
    }
    REQUIRE(world.transaction.enter(session) == status::Good);
    world.transaction.set_trust_list(0, list, {.trusted = true});
    const auto applied = world.transaction.apply("urn:busbar:test:server");
    REQUIRE_FALSE(applied);
    CHECK(applied.error().status == status::Bad_ResourceUnavailable);
    REQUIRE(world.transaction.errors().size() == 1);
    CHECK(world.transaction.errors()[0].target_id == NodeId{0, 2});
    CHECK(world.applications.list(StoreList::Trusted).size() == 1);
}

TEST_CASE("transaction: a list that is written twice has the parts of both", "[power]")
{
    World world;
    const Issued ca = issue(authority("Works CA"), key_number(2));
    const CertificateOptions options;
    const auto stranger = issue(options, key_number(1)).certificate;
    world.clock.time = today;
    CHECK(world.transaction.enter(session) == status::Good);
    CHECK(world.transaction.enter(NodeId{0, 2}) == status::Bad_TransactionPending);
    // Another user of the same session.
    const administration::detail::Holder next{session, 1};
    CHECK(world.transaction.enter(next) == status::Bad_TransactionPending);
    CHECK(world.transaction.check_end(next) == status::Bad_SessionIdInvalid);
    crypto::TrustList list = world.transaction.trust_list(0);
    list.trusted = {stranger};
    world.transaction.set_trust_list(0, list, {.trusted = true});
    list = world.transaction.trust_list(0);
    REQUIRE(list.trusted == std::vector{stranger});
    list.issuers = {ca.certificate};
    world.transaction.set_trust_list(0, list, {.issuers = true});
    CHECK(world.transaction.trust_list(1).trusted.empty()); // is another one
    // One that names other parts does not take them back.
    world.transaction.set_trust_list(0, list, {.trusted_crls = true});
    world.transaction.set_trust_list(0, list, {.issuer_crls = true});
    const auto changed = world.transaction.apply("urn:busbar:test:server");
    REQUIRE(changed);
    CHECK(changed->groups == std::vector<std::size_t>{0});
    CHECK_FALSE(changed->own);
    REQUIRE(world.applications.list(StoreList::Trusted).size() == 1);
    CHECK(world.applications.list(StoreList::Trusted)[0].thumbprint == stranger.thumbprint_text());
    REQUIRE(world.applications.list(StoreList::Issuers).size() == 1);
    CHECK(world.transaction.affected_trust_lists() == std::vector{NodeId{0, 2}});
    CHECK(world.transaction.affected_groups() == std::vector{NodeId{0, 1}});
    CHECK(world.transaction.start_time() == today);
    CHECK(world.transaction.end_time() == today);
    // There is nothing to cancel any more.
    world.transaction.cancel(status::Bad_SessionClosed);
    CHECK(world.transaction.result() == status::Good);
}

TEST_CASE("transaction: a medium that fails once leaves all as it was, or all is done", "[power]")
{
    std::string before;
    std::string after;
    std::size_t steps = 0;
    {
        World world;
        before = state_of(world.storage);
        steps = world.storage.steps();
        REQUIRE(world.change(false));
        steps = world.storage.steps() - steps;
        after = state_of(world.storage);
    }
    // Most are bytes; when it is decided, files get their names and lose them.
    std::size_t failed = 0;
    std::size_t done = 0;
    for (std::size_t step = 0; step < steps; step += step + 120 < steps ? 97 : 1) {
        World world;
        world.storage.fail_once_after(step, StorageError::Failed);
        const bool is_done = world.change(false);
        INFO(step);
        CHECK(state_of(world.storage) == (is_done ? after : before));
        CHECK_FALSE(world.transaction.is_active());
        CHECK(world.transaction.result() ==
              (is_done ? status::Good : status::Bad_ResourceUnavailable));
        ++(is_done ? done : failed);
    }
    CHECK(failed > 10);
    CHECK(done > 3);
}

TEST_CASE("transaction: a journal that makes no sense stops the changes that come after it")
{
    World world;
    const std::string before = state_of(world.storage);
    const std::string nonsense = R"([{"name":"users.json","staged":"own/private/own.pem"}])";
    const std::string journal =
        std::string{administration::detail::transaction_folder} + "/journal.json";
    REQUIRE(
        world.storage.make_folder(administration::detail::transaction_folder, FileAccess::Owner));
    REQUIRE(world.storage.replace(journal, std::as_bytes(std::span{nonsense}), FileAccess::Owner));
    const auto finished = administration::finish_changes(world.storage);
    REQUIRE_FALSE(finished);
    CHECK(finished.error().status == status::Bad_ResourceUnavailable);
    CHECK(text(finished.error()).find("cannot be finished") != std::string::npos);
    CHECK_FALSE(world.change());
    CHECK(world.transaction.result() == status::Bad_ResourceUnavailable);
    REQUIRE(world.storage.remove(journal));
    CHECK(state_of(world.storage) == before);
    // Nothing was begun on a medium that is not there.
    world.storage.set_away(true);
    CHECK(administration::finish_changes(world.storage));
}

TEST_CASE("transaction: files that cannot be removed together all stay")
{
    storage::MemoryStorage storage;
    REQUIRE(storage.make_folder("trusted/certs/old", FileAccess::Owner));
    for (const char* name : {"users.json", "trusted/certs/a.der", "trusted/certs/old/b.der"}) {
        REQUIRE(storage.replace(name, {}, FileAccess::Owner));
    }
    const auto remove = [&](std::string_view name, std::string_view folder) {
        const auto done =
            administration::remove_files(storage, std::array{name}, std::array{folder});
        return done ? "Good" : busbar::text(done.error());
    };
    const auto all = storage.names();
    CHECK(remove("../users.json", "trusted/certs").find("cannot be removed") != std::string::npos);
    storage.set_away(true);
    CHECK(remove("users.json", "trusted/certs").find("trusted/certs: cannot be removed") !=
          std::string::npos);
    storage.set_away(false);
    CHECK(storage.names() == all);
    // Folders in it are somebody else's; what is not there is as good as gone.
    CHECK(remove("roles.json", "trusted/certs") == "Good");
    CHECK_FALSE(storage.entry("trusted/certs/a.der"));
    CHECK(storage.entry("trusted/certs/old/b.der"));
    CHECK(remove("users.json", "rejected/certs") == "Good");
    CHECK_FALSE(storage.entry("users.json"));
}

} // namespace transaction_test
