// A Parquet file, row group by row group.
import { ParquetWriter, fileWriter } from 'hyparquet-writer';

const TYPES = {
  float32: { type: 'FLOAT' },
  float64: { type: 'DOUBLE' },
  int64: { type: 'INT64' },
  bool: { type: 'BOOLEAN' },
  string: { type: 'BYTE_ARRAY', converted_type: 'UTF8' },
};

// Lists in lists, three levels each, as Arrow writes and reads them.
function elements(name, dtype, depth) {
  if (depth === 0) return [{ name, repetition_type: 'OPTIONAL', ...TYPES[dtype] }];
  return [
    { name, repetition_type: 'OPTIONAL', num_children: 1, converted_type: 'LIST' },
    { name: 'list', repetition_type: 'REPEATED', num_children: 1 },
    ...elements('element', dtype, depth - 1),
  ];
}

export class Table {
  /** `columns`: [{name, dtype, depth: how many lists stand around a value}]; `metadata`: {key: text} of the file. */
  constructor(path, columns, metadata = {}) {
    this.columns = columns;
    this.writer = new ParquetWriter({
      writer: fileWriter(path),
      schema: [{ name: 'schema', num_children: columns.length }, ...columns.flatMap(({ name, dtype, depth }) => elements(name, dtype, depth))],
      codec: 'SNAPPY',
      kvMetadata: Object.entries(metadata).map(([key, value]) => ({ key, value })),
      createdBy: 'handrail export',
    });
  }

  /** One row group. `data`: an array a column, in the order of the columns. */
  write(data) {
    this.writer.write({
      columnData: this.columns.map(({ name }, i) => ({ name, data: data[i], offsetIndex: false })),
      rowGroupSize: Math.max(data[0].length, 1),
    });
  }

  /** Bytes of the file by now, also those that are not on the disk yet. */
  size() {
    return this.writer.writer.offset;
  }

  finish() {
    this.writer.finish();
  }
}
