#include "client/doctor/judge.h"
#include "client/doctor/wording.h"

namespace handrail {
namespace {

// Whether the link of what runs here needs a key.
enum class Need : std::uint8_t { kNotKnown, kNo, kYes };

Need need_of(const DoctorFacts& facts) {
  if (!facts.master.place.host.empty()) return Need::kYes;
  if (facts.master.status) return status_of(facts).peer().encrypted() ? Need::kYes : Need::kNo;
  for (const LocalProgram& program : facts.programs) {
    if (program.calls_network) return Need::kYes;
  }
  return Need::kNotKnown;
}

// The roles that a key with `roles` can work with.
Roles partners_of(Roles roles) {
  Roles out;
  if (roles.has(Role::kMaster)) out.add(Role::kSlave);
  if (roles.has(Role::kSlave) || roles.has(Role::kOperator) || roles.has(Role::kObserver)) {
    out.add(Role::kMaster);
  }
  if (roles.has(Role::kMaster)) {
    out.add(Role::kOperator);
    out.add(Role::kObserver);
  }
  return out;
}

// Those without whom nothing moves.
Roles needed_by(Roles roles) {
  Roles out;
  if (roles.has(Role::kMaster)) out.add(Role::kSlave);
  if (!roles.has(Role::kMaster)) out.add(Role::kMaster);
  return out;
}

void judge_own(const KeyFacts& keys, Need need, Findings& out) {
  const Level missing = need == Need::kYes ? Level::kProblem : Level::kNote;
  if (!keys.has_key) {
    out.push_back({"keys.own", missing,
                   "no key in " + keys.folder + ": a link between two computers needs one",
                   "handrail keys new master   (on the arm's computer: handrail keys new slave)"});
    return;
  }
  if (!keys.key_is_private) {
    out.push_back({"keys.own", Level::kProblem,
                   keys.key_path + " has mode " + keys.key_mode +
                       ", expected 0600: others can read or change it, and no program takes it",
                   "chmod 600 " + keys.key_path +
                       "   (if anybody may have read it: remove it, and make a new one)"});
    return;
  }
  if (!keys.own) {
    out.push_back({"keys.own", Level::kProblem, keys.own_problem,
                   "rm " + keys.key_path +
                       ", then handrail keys new, and have its line typed on the other computer"});
    return;
  }
  out.push_back({"keys.own", Level::kOk,
                 "key " + key_id(keys.own->key) + ", called " + keys.own->name + ", as " +
                     roles_text(keys.own->roles) + ", made " + span_text(keys.own_age_s) +
                     " ago, mode " + keys.key_mode,
                 ""});
}

void judge_trusted(const KeyFacts& keys, Findings& out) {
  if (!keys.trusted_is_ours_to_write) {
    out.push_back({"keys.trusted", Level::kProblem,
                   keys.trusted_path + " has mode " + keys.trusted_mode +
                       ", expected 0600: others can add themselves, and no program takes it",
                   "handrail keys list to look through it, then chmod 600 " + keys.trusted_path});
    return;
  }
  if (!keys.trusted) {
    out.push_back({"keys.trusted", Level::kProblem, keys.trusted_problem,
                   "mend that line, or remove " + keys.trusted_path +
                       " and have `handrail keys show` of the other computer typed here"});
    return;
  }
  std::string those;
  for (const Trusted& entry : keys.trusted->entries()) {
    those += (those.empty() ? "" : "; ") + entry.name + " as " + roles_text(entry.roles) +
             ", key " + key_id(entry.key);
  }
  out.push_back(
      {"keys.trusted", Level::kOk, those.empty() ? "nobody is trusted" : "let in: " + those, ""});
}

void judge_partner(const KeyFacts& keys, Need need, Findings& out) {
  if (!keys.own || !keys.trusted) return;
  const Roles wanted = partners_of(keys.own->roles), needed = needed_by(keys.own->roles);
  std::string can;
  bool enough = false;
  for (const Trusted& entry : keys.trusted->entries()) {
    if (!entry.roles.has_any(wanted)) continue;
    can += (can.empty() ? "" : ", ") + entry.name;
    enough = enough || entry.roles.has_any(needed);
  }
  if (enough) {
    out.push_back({"keys.partner", Level::kOk,
                   can + " can work with our key, whose role is " + roles_text(keys.own->roles),
                   ""});
    return;
  }
  const std::string role = roles_text(needed);
  out.push_back({"keys.partner", need == Need::kNo ? Level::kNote : Level::kProblem,
                 "our key's role is " + roles_text(keys.own->roles) +
                     ", and nobody is trusted here as " + role,
                 "on the " + role +
                     "'s computer: handrail keys show; then type here the line that "
                     "it prints"});
}

}  // namespace

void judge_keys(const DoctorFacts& facts, Findings& out) {
  const Need need = need_of(facts);
  judge_own(facts.keys, need, out);
  if (!facts.keys.has_key && facts.keys.trusted && facts.keys.trusted->entries().empty()) return;
  judge_trusted(facts.keys, out);
  judge_partner(facts.keys, need, out);
}

}  // namespace handrail
