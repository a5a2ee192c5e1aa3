#include "administration/transaction.hpp"

#include "managed_fixture.hpp"

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

    bool change()
    {
        static const auto next = successor();
        static const auto stranger = issue({}, key_number(1)).certificate;
        REQUIRE(transaction.enter(session) == status::Good);
        crypto::TrustList list;
        list.trusted = {stranger};
        transaction.set_trust_list(0, list, {.trusted = true});
        transaction.set_trust_list(1, list, {.trusted = true});
        transaction.set_own_certificate({next.certificates, next.key});
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
