// Operators on other computers against a served port: who is let in, as whom, and what strangers
// do.
#include <gmock/gmock.h>
#include <openssl/ssl.h>

#include <cstdlib>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>

#include "client/api/operator_client.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/master/remote_operator_server.h"
#include "tests/loopback/operator_bench.h"

namespace handrail {
namespace {

using boost::asio::ip::tcp;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr Nanos kCallPatience = 10 * kSecond;

pb::Request plain_request(void (pb::Request::*set)(bool)) {
  pb::Request request;
  (request.*set)(true);
  return request;
}

class RemoteOperators : public testing::Test {
 protected:
  RemoteOperators() {
    EXPECT_TRUE(desk_.create("desk", Role::kMaster));
    for (const auto& [name, roles] : {std::pair<const char*, Roles>{"anna", Role::kOperator},
                                      {"ben", Role::kObserver},
                                      {"cell", Role::kSlave},
                                      {"other", Role::kMaster},
                                      {"eve", Role::kOperator}}) {
      const auto own = folder_of(name).create(name, roles);
      EXPECT_TRUE(own);
      EXPECT_TRUE(own->name == "eve" || trusted_.add(own->entry()));
      TrustList desks;
      EXPECT_TRUE(desks.add(desk_.load()->entry()));
      EXPECT_TRUE(folder_of(name).save(desks, "a test"));
    }
    EXPECT_TRUE(desk_.save(trusted_, "a test"));
    EXPECT_TRUE(operators_.start(temp_.path() + "/operator.sock"));
    EXPECT_TRUE(remote_.open({*secure_options(desk_), "127.0.0.1", 0}));
    remote_.on_say([this](bool, const std::string& line) {
      const std::lock_guard<std::mutex> lock(mutex_);
      said_ += line + "\n";
    });
    const std::string place = remote_.place();
    port_ = static_cast<std::uint16_t>(std::stoi(place.substr(place.rfind(':') + 1)));
    tick();
    thread_ = std::thread([this] { io_.run(); });
  }
  ~RemoteOperators() override {
    std::promise<void> ended;
    boost::asio::post(io_, [&] {
      timer_.cancel();
      ended_ = true;
      remote_.close();
      operators_.stop();
      ended.set_value();
    });
    ended.get_future().wait();
    thread_.join();
    ::unsetenv("HANDRAIL_KEYS");
  }

  KeyFolder folder_of(const std::string& name) { return KeyFolder(temp_.path() + "/" + name); }
  std::string place() const { return "127.0.0.1:" + std::to_string(port_); }
  std::unique_ptr<OperatorClient> client(const std::string& name, const std::string& as = {}) {
    ::setenv("HANDRAIL_KEYS", (temp_.path() + "/" + name).c_str(), 1);
    MasterPlace master;
    master.host = place();
    return std::make_unique<OperatorClient>(master, as);
  }
  // What came of an order in a few words.
  static std::string outcome(const Result<pb::Reply>& reply) {
    if (!reply) return "none: " + reply.message();
    return (reply->done() ? "done: " : "refused: ") + reply->reason();
  }
  std::string said_of(const std::string& name, void (pb::Request::*set)(bool),
                      const std::string& as = {}) {
    return outcome(client(name, as)->call(plain_request(set), kCallPatience));
  }
  std::string id_of(const std::string& name) {
    return key_id(folder_of(name).load()->key.public_key());
  }
  void trust(const TrustList& list) { EXPECT_TRUE(desk_.save(list, "a test")); }
  std::string said() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return said_;
  }
  std::size_t sessions() {
    std::promise<std::size_t> number;
    boost::asio::post(io_, [&] { number.set_value(remote_.sessions()); });
    return number.get_future().get();
  }
  // False: not in ten seconds.
  static bool eventually(const std::function<bool()>& condition) {
    const Nanos give_up = monotonic_now() + kCallPatience;
    while (!condition()) {
      if (monotonic_now() > give_up) return false;
      sleep_until(monotonic_now() + kMillisecond);
    }
    return true;
  }
  // All that comes until the other side closes.
  static std::string until_closed(tcp::socket& from) {
    std::string out;
    boost::system::error_code ended;
    boost::asio::read(from, boost::asio::dynamic_buffer(out), ended);
    return out;
  }
  // A stranger's connection, from one of this computer's addresses.
  tcp::socket stranger(const char* from = "127.0.0.1") {
    tcp::socket out(strangers_);
    out.open(tcp::v4());
    out.bind({boost::asio::ip::make_address(from), 0});
    out.connect({boost::asio::ip::make_address("127.0.0.1"), port_});
    const timeval longest{kCallPatience / kSecond, 0};
    ::setsockopt(out.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &longest, sizeof(longest));
    return out;
  }
  // A ClientHello as anybody can make one.
  static std::string hello() {
    const std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context(
        SSL_CTX_new(TLS_client_method()), SSL_CTX_free);
    const std::unique_ptr<SSL, decltype(&SSL_free)> ssl(SSL_new(context.get()), SSL_free);
    BIO* const out = BIO_new(BIO_s_mem());
    SSL_set_bio(ssl.get(), BIO_new(BIO_s_mem()), out);
    SSL_set_connect_state(ssl.get());
    (void)SSL_do_handshake(ssl.get());
    std::string bytes(8192, '\0');
    bytes.resize(static_cast<std::size_t>(BIO_read(out, bytes.data(), 8192)));
    return bytes;
  }

  const TempFolder temp_;
  KeyFolder desk_{temp_.path() + "/desk"};
  TrustList trusted_;
  boost::asio::io_context io_, strangers_;
  ScriptedMaster master_;
  OperatorServer operators_{io_, master_};
  RemoteOperatorServer remote_{io_, operators_};
  std::uint16_t port_ = 0;
  boost::asio::steady_timer timer_{io_};
  bool ended_ = false;
  std::mutex mutex_;
  std::string said_;
  std::thread thread_;

 private:
  void tick() {
    timer_.expires_after(std::chrono::milliseconds(1));
    timer_.async_wait([this](boost::system::error_code) {
      if (ended_) return;
      remote_.tick(monotonic_now());
      tick();
    });
  }
};

TEST_F(RemoteOperators, AnOperatorsKeyOrdersInTheNameThatItProves) {
  const std::string answer = said_of("anna", &pb::Request::set_disengage);
  EXPECT_THAT(answer, HasSubstr("as: \"anna@" + id_of("anna") + "\""));
  EXPECT_EQ(said_of("anna", &pb::Request::set_reset), "refused: nothing to reset");
}

TEST_F(RemoteOperators, OneConnectionCarriesManyOrdersAndTheLongestAnswer) {
  const auto anna = client("anna");
  pb::Request longest;
  longest.set_scene_load(std::string(60'000, 'x'));
  for (int i = 0; i < 20; ++i) {
    const auto reply = anna->call(longest, kCallPatience);
    ASSERT_TRUE(reply) << reply.message();
    EXPECT_GT(reply->reason().size(), 60'000u);
  }
  EXPECT_EQ(sessions(), 1u);
}

TEST_F(RemoteOperators, AnObserverLooksAndOrdersNothing) {
  EXPECT_EQ(said_of("ben", &pb::Request::set_status), "done: ");
  const int before = master_.requests;
  for (const auto order : {&pb::Request::set_engage, &pb::Request::set_stop,
                           &pb::Request::set_reset, &pb::Request::set_hold_alive}) {
    EXPECT_THAT(said_of("ben", order), HasSubstr("trusted as observer, not as operator"));
  }
  EXPECT_EQ(master_.requests, before);
}

TEST_F(RemoteOperators, NobodyElseIsLetInAndEachIsToldWhatToType) {
  for (const char* name : {"cell", "other", "eve"}) {
    const std::string answer = said_of(name, &pb::Request::set_stop);
    EXPECT_THAT(answer, HasSubstr("does not trust our key " + id_of(name) + " as operator"))
        << name;
    EXPECT_THAT(answer, HasSubstr("handrail keys trust " + std::string(name) + " operator p256:"));
  }
  EXPECT_THAT(said_of("nobody", &pb::Request::set_stop),
              HasSubstr("`handrail keys new` makes one"));
  EXPECT_EQ(master_.requests, 0);
  EXPECT_THAT(said(), HasSubstr("refused: "));
}

TEST_F(RemoteOperators, AMasterWhoseKeyIsNotTrustedHearsNoOrder) {
  ASSERT_TRUE(folder_of("anna").save(TrustList(), "a test"));
  EXPECT_THAT(said_of("anna", &pb::Request::set_stop),
              HasSubstr("shows key " + id_of("desk") + ", which is not trusted here (as master"));
  TrustList as_another;
  ASSERT_TRUE(as_another.add({"desk", Role::kOperator, desk_.load()->key.public_key()}));
  ASSERT_TRUE(folder_of("anna").save(as_another, "a test"));
  EXPECT_THAT(said_of("anna", &pb::Request::set_stop),
              HasSubstr("trusted here as operator, not as master"));
  EXPECT_EQ(master_.requests, 0);
}

TEST_F(RemoteOperators, AKeyThatIsRemovedOrTrustedWithLessLosesItsConnection) {
  const auto status = plain_request(&pb::Request::set_status);
  const auto ben = client("ben");  // a key is read when the first order is given
  ASSERT_TRUE(ben->call(status, kCallPatience));
  const auto anna = client("anna");
  ASSERT_TRUE(anna->call(status, kCallPatience));
  TrustList less = trusted_;
  ASSERT_TRUE(less.remove("anna"));
  trust(less);
  EXPECT_TRUE(eventually([this] { return sessions() == 1; }));
  EXPECT_THAT(outcome(anna->call(status, kCallPatience)), HasSubstr("closed the connection"));
  EXPECT_THAT(outcome(anna->call(status, kCallPatience)), HasSubstr("does not trust our key"));
  EXPECT_EQ(outcome(ben->call(status, kCallPatience)), "done: ");
  ASSERT_TRUE(less.add({"anna", Role::kObserver, folder_of("anna").load()->key.public_key()}));
  trust(less);
  EXPECT_TRUE(eventually([this] {
    const std::string answer = said_of("anna", &pb::Request::set_stop);
    EXPECT_THAT(answer, Not(HasSubstr("done")));
    return answer.find("trusted as observer") != std::string::npos;
  }));
}

TEST_F(RemoteOperators, NobodySpeaksInAnothersName) {
  EXPECT_THAT(said_of("anna", &pb::Request::set_stop, "ben"), HasSubstr("leave out --as ben"));
  EXPECT_EQ(master_.requests, 0);
}

TEST_F(RemoteOperators, SilenceAndGarbageKeepNobodyWaiting) {
  std::vector<tcp::socket> crowd;
  for (int i = 0; i < 300; ++i) {
    crowd.push_back(stranger());
    const std::string garbage(static_cast<std::size_t>(i), static_cast<char>(i));
    boost::system::error_code gone;
    if (i % 2 == 0) boost::asio::write(crowd.back(), boost::asio::buffer(garbage), gone);
  }
  const Nanos before = monotonic_now();
  EXPECT_EQ(said_of("anna", &pb::Request::set_status), "done: ");
  // A place is free at once; one that came to an end by itself would have taken two seconds.
  EXPECT_LT(monotonic_now() - before, RemoteOperatorServer::kPatience);
}

TEST_F(RemoteOperators, WhatIsNoHelloGetsNoAnswerAndCostsNoHandshake) {
  for (const std::string& bytes : {std::string("GET / HTTP/1.1\r\n\r\n"), std::string(5, '\x16'),
                                   std::string("\x15\x03\x03\0\x02\x01\0", 7)}) {
    tcp::socket from = stranger();
    boost::asio::write(from, boost::asio::buffer(bytes));
    EXPECT_EQ(until_closed(from), "");
  }
}

TEST_F(RemoteOperators, OneNetworkHasOnlyItsShareOfThePlaces) {
  std::vector<tcp::socket> crowd;
  crowd.push_back(stranger("127.0.0.2"));
  for (std::size_t i = 0; i < RemoteOperatorServer::kMostOfOneNetwork; ++i) {
    crowd.push_back(stranger("127.0.0.3"));
  }
  EXPECT_EQ(said_of("anna", &pb::Request::set_status), "done: ");
  // One more, and the oldest of its network makes room.
  crowd.push_back(stranger("127.0.0.3"));
  EXPECT_EQ(until_closed(crowd[1]), "");
  crowd[0].non_blocking(true);
  char byte = 0;
  boost::system::error_code still;
  crowd[0].read_some(boost::asio::buffer(&byte, 1), still);
  EXPECT_EQ(still, boost::asio::error::would_block) << "a place of another network";
}

TEST_F(RemoteOperators, HellosFromManyNetworksTakeNoTurnOfAnother) {
  constexpr int kNetworks = 10, kSeconds = 6;
  const std::string bytes = hello();
  ASSERT_GT(bytes.size(), 100u);
  std::vector<tcp::socket> crowd;
  for (int i = 0; i < kSeconds * RemoteOperatorServer::kHandshakesPerSecond; ++i) {
    crowd.push_back(stranger(("127.0.1." + std::to_string(1 + i % kNetworks)).c_str()));
    boost::asio::write(crowd.back(), boost::asio::buffer(bytes));
  }
  const auto reply = client("anna")->call(plain_request(&pb::Request::set_status), 3 * kSecond);
  EXPECT_EQ(outcome(reply), "done: ") << "half of the time that those before it take";
}

TEST_F(RemoteOperators, AHandshakeThatIsNotGoneOnWithEnds) {
  tcp::socket slow = stranger();
  boost::asio::write(slow, boost::asio::buffer(hello()));
  const Nanos before = monotonic_now();
  (void)until_closed(slow);
  EXPECT_GE(monotonic_now() - before, RemoteOperatorServer::kPatience / 2);
  EXPECT_LT(monotonic_now() - before, kCallPatience);
  EXPECT_EQ(sessions(), 0u);
}

TEST_F(RemoteOperators, ObserversMakeRoomForOperators) {
  const auto status = plain_request(&pb::Request::set_status);
  std::vector<std::unique_ptr<OperatorClient>> desks;
  const auto one_more = [&] {
    desks.push_back(client("anna"));
    return desks.back()->call(status, kCallPatience).is_ok();
  };
  for (std::size_t i = 1; i < RemoteOperatorServer::kMostSessions; ++i)
    ASSERT_TRUE(one_more()) << i;
  const auto ben = client("ben");
  ASSERT_TRUE(ben->call(status, kCallPatience)) << "the last who came and spoke";
  ASSERT_TRUE(one_more());
  EXPECT_EQ(sessions(), RemoteOperatorServer::kMostSessions);
  EXPECT_THAT(outcome(ben->call(status, kCallPatience)), HasSubstr("closed the connection"));
  for (const auto& anna : desks) EXPECT_EQ(outcome(anna->call(status, kCallPatience)), "done: ");
}

TEST_F(RemoteOperators, AnOperatorsNewKeyTakesThePlaceOfTheOldOnceTheMasterHasLetItIn) {
  const PublicKey before = folder_of("anna").load()->key.public_key();
  ASSERT_TRUE(folder_of("anna").create_next());
  EXPECT_EQ(said_of("anna", &pb::Request::set_status), "done: ") << "with the old one";
  EXPECT_EQ(folder_of("anna").load()->key.public_key(), before);
  ASSERT_TRUE(desk_.trust(folder_of("anna").load()->entry()));
  EXPECT_TRUE(eventually([&] {
    EXPECT_EQ(said_of("anna", &pb::Request::set_status), "done: ");
    return folder_of("anna").load()->key.public_key() != before;
  }));
  EXPECT_TRUE(eventually([&] { return desk_.trusted()->find(before) == nullptr; }));
  EXPECT_EQ(said_of("anna", &pb::Request::set_status), "done: ") << "with the new one alone";
}

TEST_F(RemoteOperators, AMastersNewKeyTakesThePlaceOfTheOldOnceItsOperatorsKnowIt) {
  const PublicKey before = desk_.load()->key.public_key();
  TrustList few;
  ASSERT_TRUE(few.add(folder_of("anna").load()->entry()));
  trust(few);
  ASSERT_TRUE(desk_.create_next());
  const PublicKey next = desk_.load()->next->public_key();
  ASSERT_TRUE(folder_of("anna").trust(desk_.load()->entry()));
  EXPECT_TRUE(eventually([&] {
    EXPECT_EQ(said_of("anna", &pb::Request::set_status), "done: ");
    return desk_.load()->key.public_key() != before;
  }));
  EXPECT_EQ(desk_.load()->key.public_key(), next);
  EXPECT_EQ(folder_of("anna").trusted()->find(before), nullptr);
}

}  // namespace
}  // namespace handrail
