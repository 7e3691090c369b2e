// proto/foxglove.proto beside Foxglove's own schemas, field by field.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import schemas from '@foxglove/schemas/internal.js';
import protobuf from 'protobufjs';

const text = readFileSync(new URL('../../proto/foxglove.proto', import.meta.url), 'utf8');
const ours = protobuf.parse(text, { keepCase: true }).root.lookup('foxglove');
const { generateProto, foxgloveMessageSchemas, foxgloveEnumSchemas } = schemas;

const theirs = (name) => {
  const enums = Object.values(foxgloveEnumSchemas).filter((each) => each.parentSchemaName === name);
  const root = protobuf.parse(generateProto(foxgloveMessageSchemas[name], enums), { keepCase: true }).root;
  return root.lookupType(`foxglove.${name}`);
};
const fields = (type) => Object.fromEntries(type.fieldsArray.map(({ id, name, repeated, optional, options, type: of }) =>
  [id, `${repeated ? 'repeated ' : options?.proto3_optional ? 'optional ' : ''}${of.split('.').pop()} ${name}`]));
const enums = (type) => Object.fromEntries(type.nestedArray.filter((each) => each instanceof protobuf.Enum).map((each) => [each.name, { ...each.values }]));
const messages = ours.nestedArray.filter((each) => each instanceof protobuf.Type);

test('EveryMessageHasTheFieldsOfFoxglovesOwn', () => {
  assert.ok(messages.length >= 24, `${messages.length} messages`);
  for (const type of messages) {
    assert.ok(foxgloveMessageSchemas[type.name], `${type.name} is none of theirs`);
    assert.deepEqual(fields(type), fields(theirs(type.name)), type.name);
  }
});

test('EveryChoiceHasTheValuesOfFoxglovesOwn', () => {
  let compared = 0;
  for (const type of messages) {
    assert.deepEqual(enums(type), enums(theirs(type.name)), type.name);
    compared += Object.keys(enums(type)).length;
  }
  assert.equal(compared, 4);
});
